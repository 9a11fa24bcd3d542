#pragma once
// Where two surfaces are sampled. A sample is a pair of points, x_s = sum N_a y_a on a slave triangle and x_m = sum M_b y_b on a master
// triangle, with the gap g = n . (x_m - x_s) along the slave normal n and a weight w [m^2].
//
//   faces    points of the exactly clipped overlap (clip.h); w = current slave area of the piece.
//   edges    Gauss points of the master edge's projection within the slave triangle, shared like points.
//   points   the projection of a master vertex, shared between slave triangles near their edges.
// An edge or vertex belongs to the first master triangle that has it, so every sample lives on one pair of triangles. What faces, edges and
// points weigh, and to which slave triangles they belong, is the weighting's to say: consistent.h, tapered.h.
#include <cmath>

#include "effects/mortar_contact/integrate.h"
#include "effects/mortar_contact/weights.h"

namespace mortise::effects::mortar {

// Quarters of curved faces see as far as the faces themselves may stand off them.
MORTISE_HD inline double reach_of_quarters(const MortarView& s, const Patch& p, Index master) {
  return p.reach + s.bow_of(p.slave) + s.bow_of(master);
}

// May any of master i be within reach?
MORTISE_HD inline bool within(const MortarView& s, const Patch& p, Index i) {
  const Facing& f = p.facing[i];
  const double lowest = std::fmin(f.height[0], std::fmin(f.height[1], f.height[2]));
  const double highest = std::fmax(f.height[0], std::fmax(f.height[1], f.height[2]));
  return lowest < reach_of_quarters(s, p, p.master[i]) && highest > 0;
}

// Master i of a patch, seen from its slave triangle. Calls emit(kind, weight, gap, N, M) for every place where there may be a sample: what other
// masters hide, and how curved faces lie, is for the judge to say (freeze.cpp).
template <class Weights, class Emit>
struct Sampler {
  const MortarView& s;
  const Patch& p;
  const Weights& weights;
  Emit& emit;
  const Index master;
  const Vec3 n;
  const Facing& f;
  const double reach;

  MORTISE_HD Sampler(const MortarView& view, const Patch& patch, Index i, const Weights& how, Emit& to)
      : s(view),
        p(patch),
        weights(how),
        emit(to),
        master(patch.master[i]),
        n(patch.plane.n),
        f(patch.facing[i]),
        reach(reach_of_quarters(view, patch, master)) {}

  MORTISE_HD void offer(SampleKind kind, double weight, const double N[3], const double M[3]) const {
    const double gap = height(f, M);  // of the quarters, which cannot meet
    if (gap > 0 && gap < reach && weight > 0) emit(kind, weight, gap, N, M);
  }

  // The overlap at once, where weights and quadrature allow it, from its moments: those of parts by the gap (pieces 0 and 1) and of the whole (2).
  MORTISE_HD void whole_face(int piece) const {
    const double fade = weights.facing(n, s.normal[master]);
    if (!(fade > 0)) return;
    const double cut = s.bent(p.slave) || s.bent(master) ? 0 : hermite((-n.dot(s.normal[master]) - tuning::kCutNone) / tuning::kCutFade);
    const double share = piece < 2 ? cut : 1 - cut, area = s.set.pass_weight * fade * p.plane.area;
    if (!(share > 0)) return;
    Polygon poly, room[2];
    clip(f.L, poly, room[0]);
    const auto gap = [&](const Corner& c) { return height(f, c.M); };
    const auto at = [&](const Corner& c, double w) { offer(SampleKind::face, area * (piece < 2 ? cut * w : w), c.N, c.M); };
    const Polygon* of = piece < 2 ? level_of(p, piece, poly, gap, room) : &poly;
    if (of) at_moments(*of, piece < 2 ? 1 : share, at);
  }

  MORTISE_HD void fans() const {
    const double fade = weights.facing(n, s.normal[master]);
    if (!(fade > 0)) return;
    Polygon poly, room;
    clip(f.L, poly, room);
    fan_of_face(fade, poly);
  }

  // The overlap triangle by triangle.
  MORTISE_HD void fan_of_face(double fade, const Polygon& poly) const {
    MORTISE_ROLLED for (int k = 1; k + 1 < poly.n; ++k) {
      const double w = fade * p.plane.area * fan_area(poly, k);
      if (!(w > 0)) continue;
      const Corner* c[3] = {&poly.v[0], &poly.v[k], &poly.v[k + 1]};
      const auto at = [&](const double b[3], double weight) {
        double N[3], M[3];
        for (int a = 0; a < 3; ++a) {
          N[a] = b[0] * c[0]->N[a] + b[1] * c[1]->N[a] + b[2] * c[2]->N[a];
          M[a] = b[0] * c[0]->M[a] + b[1] * c[1]->M[a] + b[2] * c[2]->M[a];
        }
        const double factor = weights.on_face(M);
        if (factor > 0) offer(SampleKind::face, s.set.pass_weight * w * weight * factor, N, M);
      };
      const double corner[3] = {height(f, c[0]->M), height(f, c[1]->M), height(f, c[2]->M)};
      integrate(s, corner, p, at);
    }
  }

  // The edge from corner k.
  MORTISE_HD void edge(int k) const {
    const int l = k < 2 ? k + 1 : 0;
    const Index edge = s.topology.triangle_edge[3 * master + k];
    const Index begin = s.topology.edge_offset[edge], end = s.topology.edge_offset[edge + 1];
    const double top = std::fmin(std::fmax(f.height[k], f.height[l]), p.reach);
    if (s.topology.edge_triangle[begin] != master || !(top > 0)) return;
    Stretches stretch;
    if (!weights.stretches(p, f.L[k], f.L[l], top, stretch)) return;
    double w = s.set.pass_weight * weights.edge_weight(s, n, s.topology.edge_triangle, begin, end);
    if (!(w > 0)) return;
    w *= weights.share_of_edge(s, p, f.L[k], f.L[l], stretch);
    MORTISE_ROLLED for (int part = 0; part < 3; ++part) edge_part(k, l, w, stretch.t[part], stretch.t[part + 1]);
  }

  // From t0 to t1 of the edge between corners k and l, whose weight is w.
  MORTISE_HD void edge_part(int k, int l, double w, double t0, double t1) const {
    if (!(t1 > t0)) return;
    const auto at = [&](double along, double weight) {
      const double t = t0 + along * (t1 - t0), factor = weights.on_edge(t);
      double N[3], M[3] = {0, 0, 0};
      M[k] = 1 - t, M[l] = t;
      for (int a = 0; a < 3; ++a) N[a] = (1 - t) * f.L[k][a] + t * f.L[l][a];
      const double shared = weights.share_on_edge(p, N, height(f, M));
      if (factor * shared > 0) offer(SampleKind::edge, w * (t1 - t0) * weight * factor * shared, N, M);
    };
    const double rise = f.height[l] - f.height[k];
    integrate_segment(s, f.height[k] + t0 * rise, f.height[k] + t1 * rise, p, at);
  }

  // The vertex at corner k.
  MORTISE_HD void point(int k) const {
    const Index v = s.surface.triangles[master].v[k];
    const Index begin = s.topology.point_offset[v], end = s.topology.point_offset[v + 1];
    if (s.topology.point_triangle[begin] != master) return;
    const double N[3] = {f.L[k][0], f.L[k][1], f.L[k][2]};
    const double shared = weights.share_of_point(s, p, N, f.height[k]);
    if (!(shared > 0)) return;
    const double w = s.set.pass_weight * shared * weights.point_weight(s, n, s.topology.point_triangle, begin, end);
    double M[3] = {0, 0, 0};
    M[k] = 1;
    if (w > 0) offer(SampleKind::point, w, N, M);
  }
};

// Against a half-space: g = n_p . (x_s - p), exact for every point of the slave; w = slave area projected onto the plane. In two pieces,
// of which the second is empty where triangles are not taken at once.
template <class Emit>
MORTISE_HD inline void sample_plane(const MortarView& s, const Patch& p, const contact::Plane& plane, int piece, View<const Vec3> y, Emit& emit) {
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
    if (on.quarter >= 0) gap = std::fmax(gap, tuning::kLeastGap * p.support);
    if (gap > 0 && gap < p.reach) emit(SampleKind::face, s.set.pass_weight * cosine * p.plane.area * weight, gap, b, M);
  };
  const double corner[3] = {h[on.vertex(0)], h[on.vertex(1)], h[on.vertex(2)]};
  if (s.set.quadrature == kMoments && !s.set.tapered() && on.quarter < 0) {
    Polygon triangle;
    for (int k = 2; k >= 0; --k) triangle.push({{k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0}, {0, 0, 0}});  // turns like a master
    Polygon room[2];
    const Polygon* of = level_of(
        p, piece, triangle, [&](const Corner& c) { return c.N[0] * corner[0] + c.N[1] * corner[1] + c.N[2] * corner[2]; }, room);
    if (of) at_moments(*of, 1, [&](const Corner& c, double weight) { at(c.N, weight); });
    return;
  }
  if (piece == 0) integrate(s, corner, p, at);
}

}  // namespace mortise::effects::mortar
