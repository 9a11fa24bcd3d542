#pragma once
// Closed-form answers, written independently of the code that they check.

namespace mortise::study {

// Gap over d_hat at which the barrier carries the pressure p: the root t in (0, 1) of (1-t)(1/t - 1 - 2 ln t) = p/kappa.
double barrier_gap(double p_over_kappa);

// Hertz: sphere of radius R against a half-space (or R the effective radius), E* = 1/((1-nu1^2)/E1 + (1-nu2^2)/E2).
struct Hertz {
  double a;   // contact radius [m], a = (3 F R/(4 E*))^(1/3)
  double p0;  // largest pressure [Pa], p0 = 3F/(2 pi a^2)
  double pressure(double r) const;  // p0 sqrt(1 - r^2/a^2), 0 outside
};
Hertz hertz(double force, double radius, double e_star);

// Stiffness kappa at which a layer under pressure p is `k` times as stiff as a surface mesh of edge length h:
// kappa b''(g) h/E* = k at kappa phi(g/d_hat) = p (reference/prototype.md 3.1: 3..6 is best).
double matched_stiffness(double p, double d_hat, double h, double e_star, double k);

}  // namespace mortise::study
