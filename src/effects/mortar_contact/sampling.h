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
template <class T>
MORTISE_HD inline double reach_of_quarters(const MortarView& s, const SlaveOf<T>& p, Index master) {
  return p.reach + s.bow_of(p.slave) + s.bow_of(master);
}

// May any of master i be within reach?
MORTISE_HD inline bool within(const MortarView& s, const Patch& p, Index i) {
  const Facing& f = p.facing[i];
  const double lowest = std::fmin(f.height[0], std::fmin(f.height[1], f.height[2]));
  const double highest = std::fmax(f.height[0], std::fmax(f.height[1], f.height[2]));
  return lowest < reach_of_quarters(s, p, p.master[i]) && highest > 0;
}

// A master triangle seen from a slave triangle with the normal n. Calls emit(kind, weight, gap, N, M) for every place where there may be a sample:
// what other masters hide, and how curved faces lie, is for the judge to say (freeze.cpp). With jets as numbers T, how all that moves (moving.cpp).
template <class T, class Weights, class Emit>
struct Sampler {
  const MortarView& s;
  const SlaveOf<T>& p;
  const FacingOf<T>& f;
  const Index master;
  const Vec3 n;
  const Weights& weights;
  Emit& emit;
  const double reach;

  MORTISE_HD Sampler(const MortarView& view, const SlaveOf<T>& slave, const FacingOf<T>& facing, Index above, const Vec3& normal, const Weights& how,
                     Emit& to)
      : s(view), p(slave), f(facing), master(above), n(normal), weights(how), emit(to), reach(reach_of_quarters(view, slave, above)) {}

  MORTISE_HD void offer(SampleKind kind, const T& weight, const T N[3], const T M[3]) const {
    const T gap = height(f, M);  // of the quarters, which cannot meet
    if (gap > 0 && gap < reach && weight > 0) emit(kind, weight, gap, N, M);
  }

  // The overlap at once, where weights and quadrature allow it, from its moments: those of parts by the gap (pieces 0 and 1) and of the whole (2).
  MORTISE_HD void whole_face(int piece) const {
    const T fade = weights.facing(f.cosine);
    if (!(fade > 0)) return;
    const T cut = s.bent(p.slave) || s.bent(master) ? T(0) : hermite<T>((f.cosine - tuning::kCutNone) / tuning::kCutFade);
    const T share = piece < 2 ? cut : T(1 - cut), area = s.set.pass_weight * fade * p.area;
    if (!(share > 0)) return;
    PolygonOf<T> poly, room[2];
    clip(f.L, poly, room[0]);
    const auto gap = [&](const CornerOf<T>& c) { return height(f, c.M); };
    const auto at = [&](const CornerOf<T>& c, const T& w) { offer(SampleKind::face, area * (piece < 2 ? T(cut * w) : w), c.N, c.M); };
    const PolygonOf<T>* of = piece < 2 ? level_of(p, piece, poly, gap, room) : &poly;
    if (of) at_moments(*of, piece < 2 ? T(1) : share, at);
  }

  MORTISE_HD void fans() const {
    const T fade = weights.facing(f.cosine);
    if (!(fade > 0)) return;
    PolygonOf<T> poly, room;
    clip(f.L, poly, room);
    fan_of_face(fade, poly);
  }

  // The overlap triangle by triangle.
  MORTISE_HD void fan_of_face(const T& fade, const PolygonOf<T>& poly) const {
    MORTISE_ROLLED for (int k = 1; k + 1 < poly.n; ++k) {
      const T w = fade * p.area * fan_area(poly, k);
      if (!(w > 0)) continue;
      const CornerOf<T>* c[3] = {&poly.v[0], &poly.v[k], &poly.v[k + 1]};
      const auto at = [&](const T b[3], const T& weight) {
        T N[3], M[3];
        for (int a = 0; a < 3; ++a) {
          N[a] = b[0] * c[0]->N[a] + b[1] * c[1]->N[a] + b[2] * c[2]->N[a];
          M[a] = b[0] * c[0]->M[a] + b[1] * c[1]->M[a] + b[2] * c[2]->M[a];
        }
        const T factor = weights.on_face(M);
        if (factor > 0) offer(SampleKind::face, s.set.pass_weight * w * weight * factor, N, M);
      };
      const T corner[3] = {height(f, c[0]->M), height(f, c[1]->M), height(f, c[2]->M)};
      integrate(s, corner, p, at);
    }
  }

  // The edge from corner k.
  MORTISE_HD void edge(int k) const {
    const int l = k < 2 ? k + 1 : 0;
    const Index edge = s.topology.triangle_edge[3 * master + k];
    const Index begin = s.topology.edge_offset[edge], end = s.topology.edge_offset[edge + 1];
    const T top = smaller(larger(f.height[k], f.height[l]), T(p.support));
    if (s.topology.edge_triangle[begin] != master || !(top > 0)) return;
    Stretches<T> stretch;
    if (!weights.stretches(p, f.L[k], f.L[l], top, stretch)) return;
    double w = s.set.pass_weight * weights.edge_weight(s, n, s.topology.edge_triangle, begin, end);
    if (!(w > 0)) return;
    w *= weights.share_of_edge(s, p, n, f.L[k], f.L[l], stretch);
    MORTISE_ROLLED for (int part = 0; part < 3; ++part) edge_part(k, l, w, stretch.t[part], stretch.t[part + 1]);
  }

  // From t0 to t1 of the edge between corners k and l, whose weight is w.
  MORTISE_HD void edge_part(int k, int l, double w, const T& t0, const T& t1) const {
    if (!(t1 > t0)) return;
    const auto at = [&](const T& along, const T& weight) {
      const T t = t0 + along * (t1 - t0), factor = weights.on_edge(t);
      T N[3], M[3] = {0, 0, 0};
      M[k] = 1 - t, M[l] = t;
      for (int a = 0; a < 3; ++a) N[a] = (1 - t) * f.L[k][a] + t * f.L[l][a];
      const T shared = weights.share_on_edge(p, N, height(f, M));
      if (factor * shared > 0) offer(SampleKind::edge, w * (t1 - t0) * weight * factor * shared, N, M);
    };
    const T rise = f.height[l] - f.height[k];
    integrate_segment<T>(s, f.height[k] + t0 * rise, f.height[k] + t1 * rise, p, at);
  }

  // The vertex at corner k.
  MORTISE_HD void point(int k) const {
    const Index v = s.surface.triangles[master].v[k];
    const Index begin = s.topology.point_offset[v], end = s.topology.point_offset[v + 1];
    if (s.topology.point_triangle[begin] != master) return;
    const T N[3] = {f.L[k][0], f.L[k][1], f.L[k][2]};
    const T shared = weights.share_of_point(s, p, n, N, f.height[k]);
    if (!(shared > 0)) return;
    const T w = s.set.pass_weight * shared * weights.point_weight(s, n, s.topology.point_triangle, begin, end);
    T M[3] = {0, 0, 0};
    M[k] = 1;
    if (w > 0) offer(SampleKind::point, w, N, M);
  }
};

// Against a half-space: g = n_p . (x_s - p), exact for every point of the slave; w = slave area projected onto the plane. `shadow`: all of that area;
// h: heights of the slave's corners, and of the nodes that it hangs on. In two pieces, of which the second is empty where triangles are not taken
// at once.
template <class T, class Emit>
MORTISE_HD inline void sample_plane(const MortarView& s, const SlaveOf<T>& p, const T& shadow, const T corner[3], const T h[6], int piece,
                                    Emit& emit) {
  if (!(shadow > 0)) return;
  const FaceNodes on = s.nodes_of(p.slave);
  const T M[3] = {0, 0, 0};
  const auto at = [&](const T b[3], const T& weight) {
    double place[3] = {value_of(b[0]), value_of(b[1]), value_of(b[2])}, w[6];
    on.shape(place, w);
    T gap = 0;
    for (int k = 0; k < on.count; ++k) gap += w[k] * h[k];
    if (on.quarter >= 0) gap = larger(gap, T(tuning::kLeastGap * p.support));
    if (gap > 0 && gap < p.reach) emit(SampleKind::face, shadow * weight, gap, b, M);
  };
  if (s.set.quadrature == kMoments && !s.set.tapered() && on.quarter < 0) {
    PolygonOf<T> triangle;
    for (int k = 2; k >= 0; --k) triangle.push({{k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0}, {0, 0, 0}});  // turns like a master
    PolygonOf<T> room[2];
    const PolygonOf<T>* of = level_of(
        p, piece, triangle, [&](const CornerOf<T>& c) { return c.N[0] * corner[0] + c.N[1] * corner[1] + c.N[2] * corner[2]; }, room);
    if (of) at_moments<T>(*of, 1, [&](const CornerOf<T>& c, const T& weight) { at(c.N, weight); });
    return;
  }
  if (piece == 0) integrate(s, corner, p, at);
}

// Of a patch. Towards what turns away there is nothing.
template <class Emit>
MORTISE_HD inline void sample_plane(const MortarView& s, const Patch& p, const contact::Plane& plane, int piece, View<const Vec3> y, Emit& emit) {
  const FaceNodes on = s.nodes_of(p.slave);
  double h[6];
  for (int k = 0; k < on.count; ++k) h[k] = plane.normal.dot(y[on.point[k]] - plane.point);
  const double corner[3] = {h[on.vertex(0)], h[on.vertex(1)], h[on.vertex(2)]}, cosine = -p.plane.n.dot(plane.normal);
  sample_plane<double>(s, p, s.set.pass_weight * cosine * p.area, corner, h, piece, emit);
}

}  // namespace mortise::effects::mortar
