#pragma once
// Smoothed Coulomb friction of one contact sample (Li et al. 2020, "Incremental Potential Contact", sec. 5). With the slip u (the
// tangential relative displacement since the start of the step), x = |u| and the creep distance e = creep_speed * dt,
//     E   = mu lambda f0(x),     f0 = x^2/e - x^3/(3 e^2) + e/3  (x < e),   x  (x >= e)
//     f1  = f0' = 2 x/e - x^2/e^2 (x < e),   1 (x >= e):            force mu lambda f1 against the slip
//     Hess E = mu lambda [ f1/x (P - s s^T) + f1' s s^T ],   s = u/x,   P = I - n n^T,
// with eigenvalues f1/x > 0 and f1' >= 0: positive semi-definite as it stands.
#include <cmath>

#include "base/types.h"

namespace mortise::effects::friction {

MORTISE_HD inline double f0(double x, double e) { return x < e ? x * x * (1 / e - x / (3 * e * e)) + e / 3 : x; }
MORTISE_HD inline double f1_over_x(double x, double e) { return x < e ? (2 - x / e) / e : 1 / x; }

// Hessian of f0(|u|) for u in the plane across n.
MORTISE_HD inline Mat3 hessian(const Vec3& u, const Vec3& n, double e) {
  const double x = u.norm(), over = f1_over_x(x, e);
  Mat3 K = over * (Mat3::Identity() - n * n.transpose());
  // f1' - f1/x = -x/e^2 inside and -1/x outside
  if (x > 0) K -= (x < e ? 1 / (e * e * x) : 1 / (x * x * x)) * (u * u.transpose());
  return K;
}

}  // namespace mortise::effects::friction
