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
MORTISE_HD inline double f1(double x, double e) { return x < e ? (2 - x / e) * x / e : 1; }
MORTISE_HD inline double f1_rises(double x, double e) { return x < e ? 2 * (1 - x / e) / e : 0; }

// Hessian of f0(|u|) for u in the plane across n, with a share of how f0 softens along the slip. Share 0 is f1/x P: f0 is concave in x^2, so the
// paraboloid of that curvature touches it at u and lies above it everywhere else (Voss, Eckhardt, "Linear convergence of generalized Weiszfeld's
// method", 1980), and a step that would leap from slip over stick into slip the other way ends in between; with shares below a half, less than twice
// as far, it still goes down.
MORTISE_HD inline Mat3 hessian(const Vec3& u, const Vec3& n, double e, double softening) {
  const double x = u.norm(), over = f1_over_x(x, e);
  Mat3 K = over * (Mat3::Identity() - n * n.transpose());
  // f1' - f1/x = -x/e^2 inside and -1/x outside
  if (x > 0) K -= softening * (x < e ? 1 / (e * e * x) : 1 / (x * x * x)) * (u * u.transpose());
  return K;
}

// A sample with the ways d_k of its points since the start of the step: F_k = w_k phi on point k is minus the friction force, with
//     phi = mu lambda (f1/x) u,     u = P s,  s = sum_k w_k d_k,  P = I - n n^T.
struct Sample {
  const double* weight;  // w_k
  const Vec3* way;       // d_k [m]
  int points;
  Vec3 normal;  // n
  double load;  // mu lambda [N]
  double mu;
};

// dF_k of a change of lambda, n and w while the points stand still:
//     du = P sum dw_k d_k - dn (n . s) - n (dn . s),     d((f1/x) u) = (f1/x) du + (f1' - f1/x) s s^T du,  s = u/x,
//     dF_k = dw_k phi + w_k [ mu (f1/x) u dlambda + mu lambda d((f1/x) u) ].
MORTISE_HD inline void change(const Sample& at, double d_force, const Vec3& d_normal, const double* d_weight, double e, Vec3* d_F) {
  const Vec3& n = at.normal;
  Vec3 s = Vec3::Zero(), ds = Vec3::Zero();
  for (int k = 0; k < at.points; ++k) s += at.weight[k] * at.way[k], ds += d_weight[k] * at.way[k];
  const Vec3 u = s - n.dot(s) * n;
  const Vec3 du = ds - n.dot(ds) * n - n.dot(s) * d_normal - d_normal.dot(s) * n;
  const double x = u.norm(), over = f1_over_x(x, e);
  Vec3 pull = over * du;
  if (x > 0) pull -= (x < e ? 1 / (e * e * x) : 1 / (x * x * x)) * u.dot(du) * u;
  pull = at.mu * d_force * over * u + at.load * pull;
  for (int k = 0; k < at.points; ++k) d_F[k] = d_weight[k] * at.load * over * u + at.weight[k] * pull;
}

}  // namespace mortise::effects::friction
