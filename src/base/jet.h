#pragma once
// Numbers that carry derivatives: a + sum_i d_i e_i with e_i e_j = 0, the first N derivatives of whatever a program computes (forward mode:
// Griewank, Walther, Evaluating Derivatives, 2nd ed., ch. 3). Code that is to be differentiated is written for any number T and uses root, smaller
// and larger; comparisons look at values, so that a program takes the same way with jets and with doubles, and values have the same bits.
#include <cmath>

#include "base/hd.h"

namespace mortise {

template <int N>
struct Jet {
  double a = 0;
  double d[N] = {};

  Jet() = default;
  MORTISE_HD Jet(double value) : a(value) {}
  // The i-th variable.
  MORTISE_HD static Jet variable(double value, int i) {
    Jet out(value);
    out.d[i] = 1;
    return out;
  }

  // f(a) with derivative `slope`.
  MORTISE_HD Jet chain(double value, double slope) const {
    Jet out(value);
    for (int i = 0; i < N; ++i) out.d[i] = slope * d[i];
    return out;
  }
  MORTISE_HD Jet& operator+=(const Jet& o) { return *this = *this + o; }
  MORTISE_HD Jet& operator-=(const Jet& o) { return *this = *this - o; }
  MORTISE_HD Jet& operator*=(const Jet& o) { return *this = *this * o; }

  MORTISE_HD friend Jet operator-(const Jet& x) { return x.chain(-x.a, -1); }
  MORTISE_HD friend Jet operator+(const Jet& x, const Jet& y) {
    Jet out(x.a + y.a);
    for (int i = 0; i < N; ++i) out.d[i] = x.d[i] + y.d[i];
    return out;
  }
  MORTISE_HD friend Jet operator-(const Jet& x, const Jet& y) {
    Jet out(x.a - y.a);
    for (int i = 0; i < N; ++i) out.d[i] = x.d[i] - y.d[i];
    return out;
  }
  MORTISE_HD friend Jet operator*(const Jet& x, const Jet& y) {
    Jet out(x.a * y.a);
    for (int i = 0; i < N; ++i) out.d[i] = x.d[i] * y.a + x.a * y.d[i];
    return out;
  }
  MORTISE_HD friend Jet operator/(const Jet& x, const Jet& y) {
    Jet out(x.a / y.a);
    for (int i = 0; i < N; ++i) out.d[i] = (x.d[i] - out.a * y.d[i]) / y.a;
    return out;
  }
  MORTISE_HD friend bool operator<(const Jet& x, const Jet& y) { return x.a < y.a; }
  MORTISE_HD friend bool operator>(const Jet& x, const Jet& y) { return x.a > y.a; }
  MORTISE_HD friend bool operator<=(const Jet& x, const Jet& y) { return x.a <= y.a; }
  MORTISE_HD friend bool operator>=(const Jet& x, const Jet& y) { return x.a >= y.a; }
  MORTISE_HD friend bool operator==(const Jet& x, const Jet& y) { return x.a == y.a; }

  MORTISE_HD friend double value_of(const Jet& x) { return x.a; }
  // At 0 without derivatives, where it has none.
  MORTISE_HD friend Jet root(const Jet& x) {
    const double r = std::sqrt(x.a);
    return x.chain(r, r > 0 ? 0.5 / r : 0);
  }
  MORTISE_HD friend Jet smaller(const Jet& x, const Jet& y) { return y.a < x.a ? y : x; }
  MORTISE_HD friend Jet larger(const Jet& x, const Jet& y) { return y.a > x.a ? y : x; }
};

MORTISE_HD inline double value_of(double x) { return x; }
MORTISE_HD inline double root(double x) { return std::sqrt(x); }
MORTISE_HD inline double smaller(double x, double y) { return std::fmin(x, y); }
MORTISE_HD inline double larger(double x, double y) { return std::fmax(x, y); }

}  // namespace mortise
