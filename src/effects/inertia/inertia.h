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
  double a3 = 0;  // of q_{n-2} and v_{n-2}, only on the way to a third order (raised)
  MORTISE_HD double c() const { return a0 * a0 / (dt * dt); }
  MORTISE_HD Vec3 q_hat(const Vec3& qn, const Vec3& qn1, const Vec3& vn, const Vec3& vn1) const {
    return (a1 * qn - a2 * qn1) / a0 + dt / (a0 * a0) * (a1 * vn - a2 * vn1);
  }
  MORTISE_HD Vec3 velocity(const Vec3& q, const Vec3& qn, const Vec3& qn1) const { return (a0 * q - a1 * qn + a2 * qn1) / dt; }
};

inline Integrator backward_euler(double dt) { return {1, 1, 0, dt}; }
// BDF3, whose v is that of the cubic through q, q_n, q_{n-1} and q_{n-2}. It is never solved with: unstable for some springs without damping.
inline Integrator bdf3(double dt, double dt_prev, double dt_before) {
  const double s[4] = {0, dt, dt + dt_prev, dt + dt_prev + dt_before};  // how long ago
  double slope[4] = {0, 1, 1, 1};
  for (int j = 1; j < 4; ++j) {
    slope[0] += 1 / s[j];
    for (int k = 1; k < 4; ++k)
      if (k != j) slope[j] *= s[k] / (s[k] - s[j]);
    slope[j] /= s[j];
  }
  return {dt * slope[0], dt * slope[1], -dt * slope[2], dt, dt * slope[3]};
}
// From a by this share to b.
inline Integrator between(const Integrator& a, const Integrator& b, double share) {
  const auto mix = [share](double x, double y) { return x + share * (y - x); };
  return {mix(a.a0, b.a0), mix(a.a1, b.a1), mix(a.a2, b.a2), a.dt, mix(a.a3, b.a3)};
}
inline Integrator bdf2(double dt, double dt_prev) {
  const double w = dt / dt_prev;
  return {(1 + 2 * w) / (1 + w), 1 + w, w * w / (1 + w), dt};
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
