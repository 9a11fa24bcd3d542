#include "study/reference.h"

#include <cmath>
#include <numbers>

namespace mortise::study {

double barrier_gap(double p_over_kappa) {
  // phi falls from infinity to 0 on (0, 1); bisection in the logarithm of t/(1-t) reaches both ends.
  double lo = -80, hi = 80;
  for (int i = 0; i < 200; ++i) {
    const double s = 0.5 * (lo + hi), t = 1 / (1 + std::exp(-s)), rest = 1 / (1 + std::exp(s));  // rest = 1 - t
    const double phi = rest * (rest / t - 2 * std::log1p(-rest));
    (phi > p_over_kappa ? lo : hi) = s;
  }
  return 1 / (1 + std::exp(-0.5 * (lo + hi)));
}

double Hertz::pressure(double r) const { return r < a ? p0 * std::sqrt(1 - r * r / (a * a)) : 0; }

Hertz hertz(double force, double radius, double e_star) {
  Hertz h;
  h.a = std::cbrt(3 * force * radius / (4 * e_star));
  h.p0 = 3 * force / (2 * std::numbers::pi * h.a * h.a);
  return h;
}

double matched_stiffness(double p, double d_hat, double h, double e_star, double k) {
  // b''(t) d_hat = (1/t + 2)/t - 2 ln t - 3; the ratio to phi rises with t beyond its minimum near 0.38.
  const auto phi = [](double t) { return (1 - t) * (1 / t - 1 - 2 * std::log(t)); };
  const auto ratio = [&](double t) { return ((1 / t + 2) / t - 2 * std::log(t) - 3) / phi(t); };
  const double wanted = k * e_star * d_hat / (p * h);
  double lo = 0.376, hi = 1 - 1e-9;
  for (int i = 0; i < 100; ++i) (ratio(0.5 * (lo + hi)) < wanted ? lo : hi) = 0.5 * (lo + hi);
  return p / phi(0.5 * (lo + hi));
}

}  // namespace mortise::study
