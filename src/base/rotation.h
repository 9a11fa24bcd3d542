#pragma once
#include <cmath>

#include "base/types.h"

namespace mortise {

// [w]x, which makes w x v of v.
MORTISE_HD inline Mat3 cross_matrix(const Vec3& w) {
  Mat3 W;
  W << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return W;
}

// By an angle [rad] about the unit axis k: R = I + sin(angle) [k]x + (1 - cos(angle)) [k]x^2 (Rodrigues).
inline Mat3 rotation(const Vec3& k, double angle) {
  const Mat3 K = cross_matrix(k);
  const double half = std::sin(0.5 * angle);
  return Mat3::Identity() + std::sin(angle) * K + 2 * half * half * (K * K);
}

}  // namespace mortise
