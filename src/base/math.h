#pragma once
// Functions whose last bits differ between libraries (glibc on the CPU, libdevice on a GPU), written down once for both, so that results are
// the same on every device. Within 1 ulp (tests/base/math_test.cpp).
#include <bit>
#include <cstdint>
#include <limits>

#include "base/hd.h"

namespace mortise {

// ln x = k ln 2 + ln m, x = 2^k m, sqrt(1/2) <= m < sqrt(2). With f = m - 1, s = f/(2 + f), z = s^2:
//   ln(1 + f) = 2 artanh(s) = 2s + s R,   R = sum_{n=1} 2/(2n+1) z^n,   |s| < 0.172, so that 11 terms leave 1e-19,
//             = f - (f^2/2 - s (f^2/2 + R)),
// where f is exact and the rest a small correction to it; ln 2 is split so that k times its upper part is exact.
MORTISE_HD inline double ln(double x) {
  using Limits = std::numeric_limits<double>;
  if (!(x > 0)) return x == 0 ? -Limits::infinity() : Limits::quiet_NaN();
  if (!(x < Limits::infinity())) return x;
  int k = 0;
  if (x < Limits::min()) x *= 0x1p54, k = -54;
  // The exponent of x / sqrt(1/2), rounded down: 0x3fe6a09e00000000 are the upper bits of sqrt(1/2).
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(x), above = bits - 0x3fe6a09e00000000ull;
  const int exponent = static_cast<int>(static_cast<std::int64_t>(above) >> 52);
  k += exponent;
  const double m = std::bit_cast<double>(bits - (static_cast<std::uint64_t>(static_cast<std::int64_t>(exponent)) << 52));
  const double f = m - 1, s = f / (2 + f), z = s * s, w = z * z, half = 0.5 * f * f;
  const double even = w * (2.0 / 5 + w * (2.0 / 9 + w * (2.0 / 13 + w * (2.0 / 17 + w * (2.0 / 21)))));
  const double odd = z * (2.0 / 3 + w * (2.0 / 7 + w * (2.0 / 11 + w * (2.0 / 15 + w * (2.0 / 19 + w * (2.0 / 23))))));
  const double R = even + odd;
  constexpr double kUpper = 0x1.62e42feep-1, kLower = 0x1.a39ef35793c76p-33;  // ln 2
  return k * kUpper - ((half - (s * (half + R) + k * kLower)) - f);
}

// ln(1 + y): what rounding took from u = 1 + y is y - (u - 1), and ln(u + e) = ln u + e/u.
MORTISE_HD inline double ln1p(double y) {
  const double u = 1 + y;
  return u == 1 ? y : ln(u) + (y - (u - 1)) / u;
}

}  // namespace mortise
