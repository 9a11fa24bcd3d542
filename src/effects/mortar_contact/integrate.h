#pragma once
// Points and weights of polygons and segments, by the scene's rule.
#include <cmath>

#include "effects/mortar_contact/level_rule.h"
#include "effects/mortar_contact/moment_rule.h"
#include "effects/mortar_contact/patch.h"

namespace mortise::effects::mortar {

// Calls at(b, weight) for the points of a triangle whose corners have these gaps; weights add up to 1.
template <class At>
MORTISE_HD inline void integrate(const MortarView& s, const double gap[3], const Patch& p, const At& at) {
  if (s.set.quadrature == kExact && gap[0] > 0 && gap[1] > 0 && gap[2] > 0) {
    level_rule(gap, p.support, p.reach, at);
    return;
  }
  const int n = s.set.quadrature == kExact ? 7 : s.set.quadrature;
  for (int q = 0; q < n; ++q) {
    const TrianglePoint g = triangle_point(n, q);
    at(g.b, g.weight);
  }
}

// Three points for what of a polygon lies within the support radius, and three for what lies within reach beyond it: a strip that just
// comes near is seen, however narrow. The barrier ends so smoothly (b ~ (1 - t)^3) that cutting there adds nothing to derivatives.
// `gap` at a corner; at(corner, share of the slave triangle's area).
template <class Gap, class At>
MORTISE_HD inline void integrate_levels(const Patch& p, const Polygon& whole, const Gap& gap, const At& at) {
  const auto nothing = [](Corner&) {};
  double least = INFINITY, largest = -INFINITY;
  for (int k = 0; k < whole.n; ++k) least = std::fmin(least, gap(whole.v[k])), largest = std::fmax(largest, gap(whole.v[k]));
  for (int part = 0; part < 2; ++part) {
    const double lo = part == 0 ? -INFINITY : p.support, hi = part == 0 ? p.support : p.reach;
    if (!(lo < hi && least < hi && largest > lo)) continue;
    Polygon poly = whole;
    if (least < lo)
      poly = keep(
          poly, [&](const Corner& c) { return gap(c) - lo; }, nothing);
    if (largest > hi)
      poly = keep(
          poly, [&](const Corner& c) { return hi - gap(c); }, nothing);
    const MomentRule rule = moment_rule(poly);
    for (int q = 0; q < 3 && rule.area > 0; ++q) at(rule.at[q], rule.area / 3);
  }
}

// The same along a segment with gaps g0 and g1 at its ends: at(t, weight).
template <class At>
MORTISE_HD inline void integrate_segment(const MortarView& s, double g0, double g1, const Patch& p, const At& at) {
  if (s.set.quadrature == kExact && g0 > 0 && g1 > 0) {
    level_segment_rule(g0, g1, p.support, p.reach, at);
    return;
  }
  const int n = segment_points(s.set.quadrature);
  for (int q = 0; q < n; ++q) {
    const SegmentPoint g = segment_point(n, q);
    at(g.t, g.weight);
  }
}

}  // namespace mortise::effects::mortar
