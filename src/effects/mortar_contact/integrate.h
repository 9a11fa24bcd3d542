#pragma once
// Points and weights of polygons and segments, by the scene's rule.
#include <cmath>

#include "effects/mortar_contact/level_rule.h"
#include "effects/mortar_contact/moment_rule.h"
#include "effects/mortar_contact/patch.h"

namespace mortise::effects::mortar {

// The three points of a polygon's moments: at(corner, share of the slave triangle's area).
template <class At>
MORTISE_HD inline void at_moments(const Polygon& p, double share, const At& at) {
  const MomentRule rule = moment_rule(p);
  MORTISE_ROLLED for (int q = 0; q < 3 && rule.area > 0; ++q) at(rule.at[q], share * rule.area / 3);
}

// Calls at(b, weight) for the points of a triangle whose corners have these gaps; weights add up to 1.
template <class At>
MORTISE_HD inline void integrate(const MortarView& s, const double gap[3], const Patch& p, const At& at) {
  if (s.set.quadrature == kExact && gap[0] > 0 && gap[1] > 0 && gap[2] > 0) {
    level_rule(gap, p.support, p.reach, at);
    return;
  }
  const int n = s.set.quadrature == kExact ? 7 : s.set.quadrature;
  MORTISE_ROLLED for (int q = 0; q < n; ++q) {
    const TrianglePoint g = triangle_point(n, q);
    at(g.b, g.weight);
  }
}

// What of a polygon lies within the support radius (part 0), or within reach beyond it (part 1), where each gets three points: a strip that just
// comes near is seen, however narrow. The barrier ends so smoothly (b ~ (1 - t)^3) that cutting there adds nothing to derivatives.
// `gap` at a corner. Returns `whole`, one of `room`, or nothing.
template <class Gap>
MORTISE_HD inline const Polygon* level_of(const Patch& p, int part, const Polygon& whole, const Gap& gap, Polygon room[2]) {
  const auto nothing = [](Corner&) {};
  double least = INFINITY, largest = -INFINITY;
  MORTISE_ROLLED for (int k = 0; k < whole.n; ++k) least = std::fmin(least, gap(whole.v[k])), largest = std::fmax(largest, gap(whole.v[k]));
  const double lo = part == 0 ? -INFINITY : p.support, hi = part == 0 ? p.support : p.reach;
  if (!(lo < hi && least < hi && largest > lo)) return nullptr;
  const Polygon* of = &whole;
  if (least < lo) {
    keep(
        *of, [&](const Corner& c) { return gap(c) - lo; }, nothing, room[0]);
    of = &room[0];
  }
  if (largest > hi) {
    keep(
        *of, [&](const Corner& c) { return hi - gap(c); }, nothing, room[1]);
    of = &room[1];
  }
  return of;
}

// The same along a segment with gaps g0 and g1 at its ends: at(t, weight).
template <class At>
MORTISE_HD inline void integrate_segment(const MortarView& s, double g0, double g1, const Patch& p, const At& at) {
  if (s.set.quadrature == kExact && g0 > 0 && g1 > 0) {
    level_segment_rule(g0, g1, p.support, p.reach, at);
    return;
  }
  const int n = segment_points(s.set.quadrature);
  MORTISE_ROLLED for (int q = 0; q < n; ++q) {
    const SegmentPoint g = segment_point(n, q);
    at(g.t, g.weight);
  }
}

}  // namespace mortise::effects::mortar
