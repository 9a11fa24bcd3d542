#pragma once
// Points and weights of polygons and segments, by the scene's rule.
#include <cmath>

#include "effects/mortar_contact/level_rule.h"
#include "effects/mortar_contact/moment_rule.h"
#include "effects/mortar_contact/patch.h"

namespace mortise::effects::mortar {

// The three points of a polygon's moments: at(corner, share of the slave triangle's area).
template <class T, class At>
MORTISE_HD inline void at_moments(const PolygonOf<T>& p, const T& share, const At& at) {
  const MomentRule<T> rule = moment_rule(p);
  MORTISE_ROLLED for (int q = 0; q < 3 && rule.area > 0; ++q) at(rule.at[q], share * rule.area / 3);
}

// Calls at(b, weight) for the points of a triangle whose corners have these gaps; weights add up to 1.
template <class T, class At>
MORTISE_HD inline void integrate(const MortarView& s, const T gap[3], const SlaveOf<T>& p, const At& at) {
  if (s.set.quadrature == kExact && gap[0] > 0 && gap[1] > 0 && gap[2] > 0) {
    level_rule(gap, p.support, p.reach, at);
    return;
  }
  const int n = s.set.quadrature == kExact ? 7 : s.set.quadrature;
  MORTISE_ROLLED for (int q = 0; q < n; ++q) {
    const TrianglePoint g = triangle_point(n, q);
    const T b[3] = {g.b[0], g.b[1], g.b[2]};
    at(b, T(g.weight));
  }
}

// What of a polygon lies within the support radius (part 0), or within reach beyond it (part 1), where each gets three points: a strip that just
// comes near is seen, however narrow. The barrier ends so smoothly (b ~ (1 - t)^3) that cutting there adds nothing to derivatives.
// `gap` at a corner. Returns `whole`, one of `room`, or nothing.
template <class T, class Gap>
MORTISE_HD inline const PolygonOf<T>* level_of(const SlaveOf<T>& p, int part, const PolygonOf<T>& whole, const Gap& gap, PolygonOf<T> room[2]) {
  const auto nothing = [](CornerOf<T>&) {};
  double least = INFINITY, largest = -INFINITY;
  MORTISE_ROLLED for (int k = 0; k < whole.n; ++k) {
    const double at = value_of(gap(whole.v[k]));
    least = std::fmin(least, at), largest = std::fmax(largest, at);
  }
  const double lo = part == 0 ? -INFINITY : p.support, hi = part == 0 ? p.support : p.reach;
  if (!(lo < hi && least < hi && largest > lo)) return nullptr;
  const PolygonOf<T>* of = &whole;
  if (least < lo) {
    keep(
        *of, [&](const CornerOf<T>& c) { return gap(c) - lo; }, nothing, room[0]);
    of = &room[0];
  }
  if (largest > hi) {
    keep(
        *of, [&](const CornerOf<T>& c) { return hi - gap(c); }, nothing, room[1]);
    of = &room[1];
  }
  return of;
}

// The same along a segment with gaps g0 and g1 at its ends: at(t, weight).
template <class T, class At>
MORTISE_HD inline void integrate_segment(const MortarView& s, const T& g0, const T& g1, const SlaveOf<T>& p, const At& at) {
  if (s.set.quadrature == kExact && g0 > 0 && g1 > 0) {
    level_segment_rule(g0, g1, p.support, p.reach, at);
    return;
  }
  const int n = segment_points(s.set.quadrature);
  MORTISE_ROLLED for (int q = 0; q < n; ++q) {
    const SegmentPoint g = segment_point(n, q);
    at(T(g.t), T(g.weight));
  }
}

}  // namespace mortise::effects::mortar
