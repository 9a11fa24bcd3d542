#pragma once
// Where two surfaces are sampled and with which weights. A sample is a pair of points, x_s = sum N_a y_a on a slave triangle and
// x_m = sum M_b y_b on a master triangle, with the gap g = n . (x_m - x_s) along the slave normal n and a weight w [m^2].
//
//   faces    Gauss points of the exactly clipped overlap (clip.h); w = current slave area of the piece.
//   edges    Gauss points of the master edge's projection within the slave triangle, shared like points.
//   points   the projection of a master vertex, shared between slave triangles near their edges.
// An edge or vertex belongs to the first master triangle that has it, so every sample lives on one pair of triangles.
//
// consistent  w of faces as it is: over a covered slave triangle sum w N_a, sum w M_b are exact, which is what the patch test
//             asks for. Edges and points are there for what faces cannot see, a ridge or a tip: their w is a third of the area of
//             the adjacent triangles T times
//                 H(min_T (1 + n . n_T) / (1 - cos 10 deg))           none where a face is parallel to the slave
//               x H(max_T (1 - c . n_T) / (1 - cos 30 deg))           none where the master is flat, next to none on the
//                                                                 facets of a curved surface; c = mean normal
//               x H(-n . c / 0.2)                                     none on the far side,
//             H(s) = 3 s^2 - 2 s^3 from 0 to 1.
// tapered     the published form (gmcp.md 1.4): faces x H(min_b M_b / e), edges x H(min(t, 1-t) / e), and edge and point weights
//             that give back what the faces lose, E6 and E7: e sum_T A_T and 0.1 e^2 sum_T A_T over the facing triangles T.
// Faces at an angle to the slave fade out: tapered between 81 and 87 degrees; consistent between 49 and 70, since a gap along the slave's
// normal says nothing about a surface that slides past at an angle, and what such faces hold between them are edges and tips.
#include <cmath>

#include "effects/mortar_contact/integrate.h"
#include "effects/mortar_contact/layers.h"

namespace mortise::effects::mortar {

// Calls take(kind, weight, gap, N, M) for every sample on master i of the patch.
template <class Take>
MORTISE_HD inline void sample_master(const Scene& s, const Patch& p, Index i, View<const Vec3> y, Take& take) {
  const Index master = p.master[i];
  const Vec3 n = p.plane.n;
  const double fade = facing(s.set, n, s.normal[master]);
  const Facing f = project(s, p.plane, master, y);
  const double lowest = std::fmin(f.height[0], std::fmin(f.height[1], f.height[2]));
  const double highest = std::fmax(f.height[0], std::fmax(f.height[1], f.height[2]));
  const double reach = p.reach + s.bow_of(p.slave) + s.bow_of(master);
  if (!(lowest < reach && highest > 0)) return;
  int layers = -1;  // do others lie in between? Looked up when a sample first asks
  Sheet face;
  if (s.quarter.n > 0) face = sheet_of(s, p.plane, master, y);
  const bool bent = p.face.on.quarter >= 0 || face.on.quarter >= 0;
  const double e = s.set.taper;
  const auto offer = [&](SampleKind kind, double weight, double N[3], double M[3]) {
    double gap = height(f, M);  // of the quarters, which cannot meet
    if (!(gap > 0 && gap < reach)) return;
    if (layers < 0) layers = any_layer(s, p, i, f, y);
    if (layers) weight *= visible(s, p, i, y, N, gap);
    if (!(weight > 0)) return;
    if (bent) {
      // Faces are sampled at points of the slave, ridges and tips at their own.
      const bool of_slave = kind == SampleKind::face;
      const Vec3 fixed = of_slave ? p.face.at(N) : face.at(M);
      const Vec3 found = of_slave ? slide(face, fixed, M) : slide(p.face, fixed, N);
      gap = std::fmax(of_slave ? found[2] - fixed[2] : fixed[2] - found[2], kLeastGap * p.support);
    }
    if (gap < p.reach) take(kind, weight, gap, N, M);
  };

  if (fade > 0) {
    const Polygon poly = clip(f.L);
    const bool whole = s.set.quadrature == kMoments && e == 0;
    if (whole) {
      // Faces that are next to parallel are cut where they leave the support radius. At an angle the strips within are narrow, and move with
      // the gap, which the frozen Hessian does not know.
      const double cut = bent ? 0 : hermite((-n.dot(s.normal[master]) - 0.97) / 0.015);
      const double area = s.set.share * fade * p.plane.area;
      const auto at = [&](Corner c, double w) { offer(SampleKind::face, area * w, c.N, c.M); };
      if (cut > 0)
        integrate_levels(
            p, poly, [&](const Corner& c) { return height(f, c.M); }, [&](const Corner& c, double w) { at(c, cut * w); });
      const MomentRule rule = moment_rule(poly);
      for (int q = 0; q < 3 && cut < 1 && rule.share > 0; ++q) at(rule.at[q], (1 - cut) * rule.share / 3);
    }
    for (int k = 1; k + 1 < poly.n && !whole; ++k) {
      const double w = fade * p.plane.area * fan_share(poly, k);
      if (!(w > 0)) continue;
      const Corner* c[3] = {&poly.v[0], &poly.v[k], &poly.v[k + 1]};
      const auto at = [&](const double b[3], double weight) {
        double N[3], M[3];
        for (int a = 0; a < 3; ++a) {
          N[a] = b[0] * c[0]->N[a] + b[1] * c[1]->N[a] + b[2] * c[2]->N[a];
          M[a] = b[0] * c[0]->M[a] + b[1] * c[1]->M[a] + b[2] * c[2]->M[a];
        }
        const double taper = e > 0 ? hermite(std::fmin(M[0], std::fmin(M[1], M[2])) / e) : 1;
        if (taper > 0) offer(SampleKind::face, s.set.share * w * weight * taper, N, M);
      };
      const double corner[3] = {height(f, c[0]->M), height(f, c[1]->M), height(f, c[2]->M)};
      integrate(s, corner, p, at);
    }
  }

  for (int k = 0; k < 3; ++k) {
    const int l = k < 2 ? k + 1 : 0;
    const Index edge = s.topology.triangle_edge[3 * master + k];
    const Index begin = s.topology.edge_offset[edge], end = s.topology.edge_offset[edge + 1];
    const double top = std::fmin(std::fmax(f.height[k], f.height[l]), p.reach);
    if (s.topology.edge_triangle[begin] != master || !(top > 0)) continue;
    Stretches stretch;
    if (!(e > 0 ? one_stretch(f.L[k], f.L[l], stretch) : stretches(p, f.L[k], f.L[l], top, stretch))) continue;
    double w = s.set.share * feature_weight(s, n, s.topology.edge_triangle, begin, end, e);
    if (!(w > 0)) continue;
    if (e > 0) w *= edge_multiplicity(s, p.slave, n, f.L[k], f.L[l], stretch);
    for (int part = 0; part < 3; ++part) {
      const double t0 = stretch.t[part], t1 = stretch.t[part + 1];
      if (!(t1 > t0)) continue;
      const auto at = [&](double along, double weight) {
        const double t = t0 + along * (t1 - t0), taper = e > 0 ? hermite(std::fmin(t, 1 - t) / e) : 1;
        double N[3], M[3] = {0, 0, 0};
        M[k] = 1 - t, M[l] = t;
        for (int a = 0; a < 3; ++a) N[a] = (1 - t) * f.L[k][a] + t * f.L[l][a];
        const double shared = e > 0 ? 1 : belongs(p, N, height(f, M));
        if (taper * shared > 0) offer(SampleKind::edge, w * (t1 - t0) * weight * taper * shared, N, M);
      };
      const double rise = f.height[l] - f.height[k];
      integrate_segment(s, f.height[k] + t0 * rise, f.height[k] + t1 * rise, p, at);
    }
  }

  for (int k = 0; k < 3; ++k) {
    const Index v = s.surface.triangles[master].v[k];
    const Index begin = s.topology.point_offset[v], end = s.topology.point_offset[v + 1];
    if (s.topology.point_triangle[begin] != master) continue;
    double N[3] = {f.L[k][0], f.L[k][1], f.L[k][2]};
    const double shared =
        e > 0 ? (N[0] >= -kOnSide && N[1] >= -kOnSide && N[2] >= -kOnSide ? multiplicity(s, p.slave, n, N) : 0) : belongs(p, N, f.height[k]);
    if (!(shared > 0)) continue;
    const double w = s.set.share * shared * feature_weight(s, n, s.topology.point_triangle, begin, end, 0.1 * e * e);
    double M[3] = {0, 0, 0};
    M[k] = 1;
    if (w > 0) offer(SampleKind::point, w, N, M);
  }
}

// Against a half-space: g = n_p . (x_s - p), exact for every point of the slave; w = slave area projected onto the plane.
template <class Take>
MORTISE_HD inline void sample_plane(const Scene& s, const Patch& p, const contact::Plane& plane, View<const Vec3> y, Take& take) {
  const double cosine = -p.plane.n.dot(plane.normal);
  if (!(cosine > 0)) return;
  const FaceNodes on = s.nodes_of(p.slave);
  double h[6], w[6];
  for (int k = 0; k < on.count; ++k) h[k] = plane.normal.dot(y[on.point[k]] - plane.point);
  const double M[3] = {0, 0, 0};
  const auto at = [&](const double b[3], double weight) {
    on.shape(b, w);
    double gap = 0;
    for (int k = 0; k < on.count; ++k) gap += w[k] * h[k];
    if (on.quarter >= 0) gap = std::fmax(gap, kLeastGap * p.support);
    if (gap > 0 && gap < p.reach) take(SampleKind::face, s.set.share * cosine * p.plane.area * weight, gap, b, M);
  };
  const double corner[3] = {h[on.vertex(0)], h[on.vertex(1)], h[on.vertex(2)]};
  if (s.set.quadrature == kMoments && s.set.taper == 0 && on.quarter < 0) {
    Polygon triangle;
    for (int k = 2; k >= 0; --k) triangle.push({{k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0}, {0, 0, 0}});  // turns like a master
    integrate_levels(
        p, triangle, [&](const Corner& c) { return c.N[0] * corner[0] + c.N[1] * corner[1] + c.N[2] * corner[2]; },
        [&](const Corner& c, double share) { at(c.N, share); });
    return;
  }
  integrate(s, corner, p, at);
}

}  // namespace mortise::effects::mortar
