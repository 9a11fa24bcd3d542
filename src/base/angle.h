#pragma once
// Angles in kernels, from sums and products alone: the same bits on every device (base/math.h). Within 2e-15 (tests/base/angle_test.cpp).
#include <cmath>

#include "base/hd.h"

namespace mortise {

struct Turn {
  double cos, sin;
};

// Of an angle within (-pi, pi), or a little more: by the series of an eighth of it, doubled three times.
//   cos x - 1 = -x^2/2 + ... + x^16/16!,  sin x = x - ... - x^15/15!    |x| < 0.4: the next terms are below 1e-19
MORTISE_HD inline Turn turn_by(double angle) {
  const double x = 0.125 * angle, z = x * x;
  double less = -z / 2 * (1 - z / 12 * (1 - z / 30 * (1 - z / 56 * (1 - z / 90 * (1 - z / 132 * (1 - z / 182 * (1 - z / 240)))))));
  double sine = x * (1 - z / 6 * (1 - z / 20 * (1 - z / 42 * (1 - z / 72 * (1 - z / 110 * (1 - z / 156 * (1 - z / 210)))))));
  for (int k = 0; k < 3; ++k) {  // cos 2x - 1 = -2 sin^2 x, sin 2x = 2 sin x cos x
    const double next = -2 * sine * sine;
    sine = 2 * sine * (1 + less);
    less = next;
  }
  return {1 + less, sine};
}

// The angle of (k, s) in (-pi, pi]; 0 of (0, 0). A guess within 0.005, and the small angle that is left after turning back by it.
MORTISE_HD inline double angle_of(double k, double s) {
  constexpr double kPi = 3.141592653589793;
  const double x = std::fabs(k), y = std::fabs(s), large = x > y ? x : y, small = x > y ? y : x;
  if (!(large > 0)) return large == 0 ? 0.0 : large;
  const double r = small / large;
  double guess = r * (0.25 * kPi + 0.273 * (1 - r));
  if (y > x) guess = 0.5 * kPi - guess;
  if (k < 0) guess = kPi - guess;
  if (s < 0) guess = -guess;
  const Turn back = turn_by(guess);
  const double a = k / large, b = s / large, t = (b * back.cos - a * back.sin) / (a * back.cos + b * back.sin), z = t * t;
  return guess + t * (1 - z * (1.0 / 3 - z * (1.0 / 5 - z * (1.0 / 7 - z / 9))));
}

}  // namespace mortise
