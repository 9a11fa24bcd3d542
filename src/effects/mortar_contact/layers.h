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

// Barycentrics M on a master's plane of what lies above the slave's point N; false where that plane stands upright.
MORTISE_HD inline bool over(const Facing& f, const double N[3], double M[3]) {
  const double ax = f.L[1][1] - f.L[0][1], ay = f.L[1][2] - f.L[0][2], bx = f.L[2][1] - f.L[0][1], by = f.L[2][2] - f.L[0][2];
  const double px = N[1] - f.L[0][1], py = N[2] - f.L[0][2], det = ax * by - ay * bx;
  if (det == 0) return false;
  M[1] = (px * by - py * bx) / det, M[2] = (ax * py - ay * px) / det, M[0] = 1 - M[1] - M[2];
  return true;
}

// How much of what lies at gap g above the slave's point N a master hides: it must lie in between, and hides less and less outside of
// its rim, up to as far as the distance of the two. Stacked layers must not add up.
MORTISE_HD inline double covers(const Facing& f, const Triangle& t, View<const Vec3> y, const double N[3], double g) {
  double M[3];
  if (!over(f, N, M)) return 0;
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
// Do bounds of two masters in the slave plane, whose altitudes these are, come as near each other as `distance` [m]?
MORTISE_HD inline bool come_near(const Vec3& altitude, const Facing& i, const Facing& j, double distance) {
  for (int c = 0; c < 3; ++c) {
    const auto lo = [c](const Facing& f) { return std::fmin(f.L[0][c], std::fmin(f.L[1][c], f.L[2][c])); };
    const auto hi = [c](const Facing& f) { return std::fmax(f.L[0][c], std::fmax(f.L[1][c], f.L[2][c])); };
    const double strip = distance / altitude[c];
    if (!(lo(i) < hi(j) + strip && lo(j) < hi(i) + strip)) return false;
  }
  return true;
}
// How far, at least, two masters are from each other in the slave plane: over sides of the one that have all of the other beyond them [m].
MORTISE_HD inline double apart(const Patch& p, const Facing& i, const Facing& j) {
  const double length = p.plane.e1.norm(), aside = p.plane.e1.dot(p.plane.e2) / length, up = 2 * p.plane.area / length;
  const Facing* of[2] = {&i, &j};
  double x[2][3], y[2][3], most = 0;
  for (int f = 0; f < 2; ++f)
    for (int k = 0; k < 3; ++k) x[f][k] = of[f]->L[k][1] * length + of[f]->L[k][2] * aside, y[f][k] = of[f]->L[k][2] * up;
  for (int f = 0; f < 2; ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = k, b = (k + 1) % 3, own = (k + 2) % 3, other = 1 - f;
      const double ex = x[f][b] - x[f][a], ey = y[f][b] - y[f][a], size = std::sqrt(ex * ex + ey * ey);
      const auto left = [&](int g, int v) { return ex * (y[g][v] - y[f][a]) - ey * (x[g][v] - x[f][a]); };
      const double sign = left(f, own) > 0 ? -1 : 1;
      const double beyond = std::fmin(sign * left(other, 0), std::fmin(sign * left(other, 1), sign * left(other, 2)));
      if (size > 0) most = std::fmax(most, beyond / size);
    }
  return most;
}
// Could j hide any part of i? covers() fades over how far the plane of j is below i, which is nothing between close parts of one smooth surface.
MORTISE_HD inline bool could_hide(const Patch& p, const Vec3& altitude, const Facing& i, const Facing& j) {
  const double top = std::fmax(i.height[0], std::fmax(i.height[1], i.height[2])), floor = std::fmin(j.height[0], std::fmin(j.height[1], j.height[2]));
  if (!(floor < top) || !come_near(altitude, i, j, top - floor)) return false;
  double below = 0;
  for (int k = 0; k < 3; ++k) {
    double M[3];
    if (!over(j, i.L[k], M)) return false;
    below = std::fmax(below, i.height[k] - height(j, M));
  }
  return below > apart(p, i, j);
}
MORTISE_HD inline bool any_layer(const MortarView& s, const Patch& p, Index i) {
  const Vec3 altitude(p.altitude(0), p.altitude(1), p.altitude(2));
  for (Index j = 0; j < p.masters; ++j)
    if (could_hide(p, altitude, p.facing[i], p.facing[j]) && may_cover(s, p, i, j)) return true;
  return false;
}
// Share of what master i shows at N that no other master hides. What hides a part of it is, in the slave plane, within g of there.
MORTISE_HD inline double visible(const MortarView& s, const Patch& p, Index i, View<const Vec3> y, const double N[3], double g) {
  const double strip[3] = {g / p.altitude(0), g / p.altitude(1), g / p.altitude(2)};
  const auto beside = [&](const Facing& f, int c) {
    return N[c] + strip[c] < std::fmin(f.L[0][c], std::fmin(f.L[1][c], f.L[2][c])) ||
           N[c] - strip[c] > std::fmax(f.L[0][c], std::fmax(f.L[1][c], f.L[2][c]));
  };
  double hidden = 0;
  for (Index j = 0; j < p.masters; ++j) {
    const Facing& f = p.facing[j];
    if (beside(f, 0) || beside(f, 1) || beside(f, 2) || !may_cover(s, p, i, j)) continue;
    hidden += covers(f, s.surface.triangles[p.master[j]], y, N, g);
  }
  return hidden < 1 ? 1 - hidden : 0;
}

}  // namespace mortise::effects::mortar
