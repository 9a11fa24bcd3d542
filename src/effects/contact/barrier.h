#pragma once
// The physical barrier (Li, Kaufman, Jiang 2023, "Convergent Incremental Potential Contact"): with t = g / d_hat, 0 < t < 1,
//     b(g)   = -d_hat (t - 1)^2 ln t                  [m]
//     b'(g)  = -phi(t),   phi(t) = (1-t)(1/t - 1 - 2 ln t) >= 0
//     b''(g) = [ (1/t + 2)/t - 2 ln t - 3 ] / d_hat   [1/m],  > 0
// and all three are 0 for t >= 1 (b is C2 there). kappa b is an energy per area, so kappa [Pa] is a pressure: p = kappa phi(t).
#include <cmath>

#include "base/math.h"

namespace mortise::effects::barrier {

MORTISE_HD inline double value(double g, double d_hat) {
  if (g >= d_hat) return 0;
  const double t = g / d_hat;
  return -d_hat * (t - 1) * (t - 1) * ln(t);
}

MORTISE_HD inline double phi(double t) { return t >= 1 ? 0 : (1 - t) * (1 / t - 1 - 2 * ln(t)); }

MORTISE_HD inline double first(double g, double d_hat) { return -phi(g / d_hat); }

MORTISE_HD inline double second(double g, double d_hat) {
  if (g >= d_hat) return 0;
  const double t = g / d_hat;
  return ((1 / t + 2) / t - 2 * ln(t) - 3) / d_hat;
}

// t with phi(t) = P for P > 0: the gap at pressure p is d_hat phi^-1(p/kappa). phi is convex and falls, and
// phi(t) >= (1-t)^2/t because -ln t >= 0; so the root of (1-t)^2 = P t lies left of the solution and Newton rises to it.
MORTISE_HD inline double phi_inverse(double P) {
  double t = 1 / (1 + P / 2 + std::sqrt(P + P * P / 4));
  for (int i = 0; i < 100; ++i) {
    const double slope = -((1 / t + 2) / t - 2 * ln(t) - 3);
    const double next = t - (phi(t) - P) / slope;
    if (!(next > t && next < 1)) break;
    t = next;
  }
  return t;
}

}  // namespace mortise::effects::barrier
