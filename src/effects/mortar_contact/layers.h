#pragma once
// A master triangle seen from a slave triangle, and what lies in between.
#include <cmath>

#include "effects/mortar_contact/patch.h"

namespace mortise::effects::mortar {

MORTISE_HD inline Facing project(const MortarView& s, const SlavePlane& plane, Index master, View<const Vec3> y) {
  Facing f;
  for (int k = 0; k < 3; ++k) f.height[k] = project(plane, y[s.surface.triangles[master].v[k]], f.L[k]);
  return f;
}

template <class T>
MORTISE_HD inline T height(const FacingOf<T>& f, const T M[3]) {
  return M[0] * f.height[0] + M[1] * f.height[1] + M[2] * f.height[2];
}

// Triangles list[begin] ... list[end - 1].
struct Ring {
  View<const Index> list;
  Index begin = 0, end = 0;
};
// At the side of a triangle where barycentric k is 0: it and its neighbours.
MORTISE_HD inline Ring over_side(const MortarView& s, Index triangle, int k) {
  const Index edge = s.topology.triangle_edge[3 * triangle + (k + 1) % 3];
  return {s.topology.edge_triangle, s.topology.edge_offset[edge], s.topology.edge_offset[edge + 1]};
}

// How much of what lies at gap g above the slave's point N a master hides: it must lie in between, and hides less and less outside of
// its rim, up to as far as the distance of the two. Stacked layers must not add up.
MORTISE_HD inline double covers(const Facing& f, const Triangle& t, View<const Vec3> y, const double N[3], double g) {
  const double ax = f.L[1][1] - f.L[0][1], ay = f.L[1][2] - f.L[0][2], bx = f.L[2][1] - f.L[0][1], by = f.L[2][2] - f.L[0][2];
  const double px = N[1] - f.L[0][1], py = N[2] - f.L[0][2], det = ax * by - ay * bx;
  if (det == 0) return 0;
  double M[3];
  M[1] = (px * by - py * bx) / det, M[2] = (ax * py - ay * px) / det, M[0] = 1 - M[1] - M[2];
  const double h = height(f, M);
  if (!(h > 0 && h < g)) return 0;
  const Vec3 corner[3] = {y[t.v[0]], y[t.v[1]], y[t.v[2]]};
  return hermite(1 + rim_distance(corner, M) / (g - h));
}
// The same from places: of the slave's and the master's corners.
template <class T>
MORTISE_HD inline T covers(const Vec3Of<T> y[3], const Vec3Of<T> x[3], const T N[3], const T& g) {
  const Vec3Of<T> across = cross<T>(y[1] - y[0], y[2] - y[0]), over = cross<T>(x[1] - x[0], x[2] - x[0]);
  const Vec3Of<T> n = T(1 / root(across.squaredNorm())) * across, at = N[0] * y[0] + N[1] * y[1] + N[2] * y[2];
  const T h = (x[0] - at).dot(over) / n.dot(over);
  if (!(h > 0 && h < g)) return 0;
  const Vec3Of<T> up = at + h * n - x[0];
  T M[3];
  M[1] = cross<T>(up, x[2] - x[0]).dot(over) / over.squaredNorm(), M[2] = cross<T>(x[1] - x[0], up).dot(over) / over.squaredNorm(),
  M[0] = 1 - M[1] - M[2];
  return hermite<T>(1 + rim_distance(x, M) / (g - h));
}
MORTISE_HD inline bool may_cover(const MortarView& s, const Patch& p, Index i, Index j) {
  if (i == j || !(-p.plane.n.dot(s.normal[p.master[j]]) > tuning::kLayerFaces)) return false;
  const Triangle a = s.surface.triangles[p.master[i]], b = s.surface.triangles[p.master[j]];
  for (int k = 0; k < 3; ++k)
    if (contact::has(a, b.v[k])) return false;  // neighbours of one surface
  return true;
}
// Bounds of a master in the slave plane and along the normal: could j hide any part of i?
MORTISE_HD inline bool boxes_overlap(const Patch& p, const Facing& i, const Facing& j) {
  const double top = std::fmax(i.height[0], std::fmax(i.height[1], i.height[2])), floor = std::fmin(j.height[0], std::fmin(j.height[1], j.height[2]));
  if (!(floor < top)) return false;
  for (int c = 0; c < 3; ++c) {
    const auto lo = [c](const Facing& f) { return std::fmin(f.L[0][c], std::fmin(f.L[1][c], f.L[2][c])); };
    const auto hi = [c](const Facing& f) { return std::fmax(f.L[0][c], std::fmax(f.L[1][c], f.L[2][c])); };
    const double strip = (top - floor) / p.altitude(c);  // covers() fades over no more
    if (!(lo(i) < hi(j) + strip && lo(j) < hi(i) + strip)) return false;
  }
  return true;
}
MORTISE_HD inline bool any_layer(const MortarView& s, const Patch& p, Index i) {
  for (Index j = 0; j < p.masters; ++j)
    if (may_cover(s, p, i, j) && boxes_overlap(p, p.facing[i], p.facing[j])) return true;
  return false;
}
// Share of what master i shows at N that no other master hides.
MORTISE_HD inline double visible(const MortarView& s, const Patch& p, Index i, View<const Vec3> y, const double N[3], double g) {
  double hidden = 0;
  for (Index j = 0; j < p.masters; ++j)
    if (may_cover(s, p, i, j)) hidden += covers(p.facing[j], s.surface.triangles[p.master[j]], y, N, g);
  return hidden < 1 ? 1 - hidden : 0;
}

}  // namespace mortise::effects::mortar
