#pragma once
// Differences that a time integrator takes for rates, with w = dt / dt_prev and n the last accepted state:
//     v = D q = (a0 q - a1 q_n + a2 q_{n-1}) / dt,     a = D v
//   backward Euler:      a0 = 1,  a1 = 1,  a2 = 0
//   variable-step BDF2:  a0 = (1 + 2w)/(1 + w),  a1 = 1 + w,  a2 = w^2/(1 + w)
// Hairer, Wanner: Solving Ordinary Differential Equations II. Whatever has a rate takes that of the step (StepInfo::integrator).
#include "base/types.h"

namespace mortise::effects {

struct Integrator {
  double a0 = 1, a1 = 1, a2 = 0, dt = 0;
  // D q, of positions or of coordinates.
  template <class T>
  MORTISE_HD T rate(const T& q, const T& qn, const T& qn1) const {
    return (a0 * q - a1 * qn + a2 * qn1) / dt;
  }
};

inline Integrator backward_euler(double dt) { return {1, 1, 0, dt}; }
inline Integrator bdf2(double dt, double dt_prev) {
  const double w = dt / dt_prev;
  return {(1 + 2 * w) / (1 + w), 1 + w, w * w / (1 + w), dt};
}

// What steps leave out, to first order. Of the true motion
//   backward Euler:      q' = D q + dt/2 q''               v' = D v + dt/2 v''
//   variable-step BDF2:  q' = D q + g dt^2 q'''            v' = D v + g dt^2 v''',           g = (1 + w) / (6 w)
// where q'' = a, v'' = q''' = (a - a_n)/dt and v''' = 2 w / (1 + w) (a - a_n - w (a_n - a_{n-1}))/dt^2 are differences again. Mended by a share s,
//   v = D q + s dt (v0 a - v1 a_n),      a = alpha + s (a0 alpha - a1 a_n + a2 a_{n-1}),
// alpha being D v with D q for the v of this step and what is mended in those before, but for terms with s^2. known: how many accelerations before a
// there are.
struct LeftOut {
  double a0 = 0, a1 = 0, a2 = 0, v0 = 0, v1 = 0;
  double rate(double dt, double a, double an) const { return dt * (v0 * a - v1 * an); }
  double acceleration(double a, double an, double an1) const { return a0 * a - a1 * an + a2 * an1; }
};
inline LeftOut left_out(const Integrator& of, int known) {
  if (of.a2 == 0) return known > 0 ? LeftOut{1, 0.5, 0, 0.5, 0} : LeftOut{0.5, 0, 0, 0.5, 0};
  const double w = of.a1 - 1, g = (1 + w) / (6 * w), a0 = of.a0 * g + 1.0 / 3;
  return known > 1 ? LeftOut{a0, of.a0 * g + (1 + w) / 3, w / 3, g, g} : LeftOut{a0, a0, 0, g, g};
}

}  // namespace mortise::effects
