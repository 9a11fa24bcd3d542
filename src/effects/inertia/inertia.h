#pragma once
// Inertia as an incremental potential. A time integrator turns M a = f(q) at the end of the step into the minimum of
//     1/2 c |q - q_hat|^2_M + (potential of f),       c [1/s^2],
// whose gradient is c M (q - q_hat) = M a. Both integrators read, with w = dt / dt_prev,
//     v = (a0 q - a1 q_n + a2 q_{n-1}) / dt,     a = (a0 v - a1 v_n + a2 v_{n-1}) / dt            (n: last accepted state)
//   backward Euler:      a0 = 1,  a1 = 1,  a2 = 0
//   variable-step BDF2:  a0 = (1 + 2w)/(1 + w),  a1 = 1 + w,  a2 = w^2/(1 + w)
// Putting v into a:  a = c (q - q_hat)  with
//     c = (a0/dt)^2,    q_hat = (a1 q_n - a2 q_{n-1})/a0 + dt/a0^2 (a1 v_n - a2 v_{n-1}).
#include "base/types.h"

namespace mortise::effects::inertia {

struct Integrator {
  double a0 = 1, a1 = 1, a2 = 0, dt = 0;
  MORTISE_HD double c() const { return a0 * a0 / (dt * dt); }
  MORTISE_HD Vec3 q_hat(const Vec3& qn, const Vec3& qn1, const Vec3& vn, const Vec3& vn1) const {
    return (a1 * qn - a2 * qn1) / a0 + dt / (a0 * a0) * (a1 * vn - a2 * vn1);
  }
  MORTISE_HD Vec3 velocity(const Vec3& q, const Vec3& qn, const Vec3& qn1) const { return (a0 * q - a1 * qn + a2 * qn1) / dt; }
};

inline Integrator backward_euler(double dt) { return {1, 1, 0, dt}; }
inline Integrator bdf2(double dt, double dt_prev) {
  const double w = dt / dt_prev;
  return {(1 + 2 * w) / (1 + w), 1 + w, w * w / (1 + w), dt};
}

// What steps leave out, to first order. Of the true motion, with D the difference above of the integrator (v = D q, a = D v),
//   backward Euler:      q' = D q + dt/2 q''               v' = D v + dt/2 v''
//   variable-step BDF2:  q' = D q + g dt^2 q'''            v' = D v + g dt^2 v''',           g = (1 + w) / (6 w)
// where q'' = a, v'' = q''' = (a - a_n)/dt and v''' = 2 w / (1 + w) (a - a_n - w (a_n - a_{n-1}))/dt^2 are differences again. Mended by a share s,
//   v = D q + s dt (v0 a - v1 a_n),      a = D v + s (...) = alpha + s (a0 alpha - a1 a_n + a2 a_{n-1}),      alpha = c (q - q_hat),
// with q_hat of such velocities, but for terms with s^2. known: how many accelerations before a there are.
struct LeftOut {
  double a0 = 0, a1 = 0, a2 = 0, v0 = 0, v1 = 0;
};
inline LeftOut left_out(const Integrator& of, double dt_prev, int known) {
  if (of.a2 == 0) return known > 0 ? LeftOut{1, 0.5, 0, 0.5, 0} : LeftOut{0.5, 0, 0, 0.5, 0};
  const double w = of.dt / dt_prev, g = (1 + w) / (6 * w), a0 = of.a0 * g + 1.0 / 3;
  return known > 1 ? LeftOut{a0, of.a0 * g + (1 + w) / 3, w / 3, g, g} : LeftOut{a0, a0, 0, g, g};
}

// One entry m_ij [kg] of the mass matrix, i <= j, with d = q - q_hat; it stands for m_ji as well.
//   energy   i = j: 1/2 c m d_i.d_i           i < j: c m d_i.d_j
//   gradient i = j: c m d_i                   i < j: c m d_j (block i), c m d_i (block j)
//   Hessian  i = j: c m I                     i < j: c m I (pair i, j), zero on the diagonal
// A single pair is not positive semi-definite; their sum is, because M is.
MORTISE_HD inline double energy(bool diagonal, double cm, const Vec3& di, const Vec3& dj) { return (diagonal ? 0.5 : 1.0) * cm * di.dot(dj); }

// What the pair adds to T(q) - T(q_n) - M a . (q - q_n), a = c (q - q_hat): velocities v now and vn before, d = q - q_hat, w = q - q_n [J].
MORTISE_HD inline double own_gain(bool diagonal, double m, double c, const Vec3 (&v)[2], const Vec3 (&vn)[2], const Vec3 (&d)[2],
                                  const Vec3 (&w)[2]) {
  return energy(diagonal, m, v[0], v[1]) - energy(diagonal, m, vn[0], vn[1]) - c * m * (diagonal ? d[0].dot(w[0]) : d[0].dot(w[1]) + d[1].dot(w[0]));
}

}  // namespace mortise::effects::inertia
