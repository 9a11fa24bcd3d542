#include "bench/reference.h"

#include <cmath>
#include <numbers>

namespace mortise::bench {

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

Hertz hertz_line(double line_load, double radius, double e_star) {
  Hertz h;
  h.a = 2 * std::sqrt(line_load * radius / (std::numbers::pi * e_star));
  h.p0 = 2 * line_load / (std::numbers::pi * h.a);
  return h;
}

double flat_punch_force(double a, double e_star, double depth) { return 2 * a * e_star * depth; }
double flat_punch_pressure(double force, double a, double r) { return force / (2 * std::numbers::pi * a * a * std::sqrt(1 - r * r / (a * a))); }

double cone_force(double slope, double e_star, double depth) { return 2 / std::numbers::pi * e_star * depth * depth / slope; }
double cone_radius(double slope, double e_star, double force) { return std::sqrt(2 * force / (std::numbers::pi * e_star * slope)); }
double cone_pressure(double slope, double e_star, double a, double r) { return r < a ? 0.5 * e_star * slope * std::acosh(a / r) : 0; }

double flat_punch_surface(double a, double r) { return 2 / std::numbers::pi * std::asin(a / r); }
double cone_surface(double a, double r) { return 2 / std::numbers::pi * (std::asin(a / r) + std::sqrt(r * r / (a * a) - 1) - r / a); }

double pin_pressure(double half_angle, double angle) {
  const double b = std::tan(0.5 * half_angle), y = std::tan(0.5 * angle);
  if (std::abs(y) >= b) return 0;
  const double c = std::sqrt(1 + b * b), s = std::sqrt(b * b - y * y);
  return 2 / std::numbers::pi * s / ((1 + y * y) * c) + std::log((c + s) / (c - s)) / (2 * std::numbers::pi * b * b * c * c);
}

double pin_moment(double half_angle) {
  // angle = half_angle sin u takes the root out of the ends.
  double sum = 0, moment = 0;
  constexpr int n = 400;
  for (int i = 0; i < n; ++i) {
    const double u = 0.5 * std::numbers::pi * (i + 0.5) / n, angle = half_angle * std::sin(u), w = pin_pressure(half_angle, angle) * std::cos(u);
    sum += w, moment += w * std::sin(angle) * std::sin(angle);
  }
  return moment / sum;
}

namespace {

// x in (lo, hi) with f(x) = 0, where f rises.
template <class F>
double root(double lo, double hi, const F& f) {
  for (int i = 0; i < 100; ++i) (f(0.5 * (lo + hi)) < 0 ? lo : hi) = 0.5 * (lo + hi);
  return 0.5 * (lo + hi);
}

}  // namespace

double pin_half_angle(double clearance_over_load) {
  return root(1e-6, 0.5 * std::numbers::pi, [&](double angle) {
    const double q = std::pow(std::tan(0.5 * angle), 2);
    return clearance_over_load - (2 - 2 * q * q - std::log1p(q)) / (std::numbers::pi * q * (1 + q));
  });
}

double pin_half_angle_of_moment(double moment) {
  return root(1e-6, 0.5 * std::numbers::pi, [&](double angle) { return pin_moment(angle) - moment; });
}

double pressed_rings_pressure(double a, double b, double bore, double c, double D, double modulus) {
  const double outer = (c * c + bore * bore) / (c * c - bore * bore), inner = (b * b + a * a) / (b * b - a * a);
  return D * modulus / (b * (outer + inner));
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

}  // namespace mortise::bench
