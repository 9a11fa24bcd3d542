#pragma once
// Inertia as an incremental potential. A time integrator turns M a = f(q) at the end of the step into the minimum of
//     1/2 c |q - q_hat|^2_M + (potential of f),       c [1/s^2],
// whose gradient is c M (q - q_hat) = M a: of v = D q and a = D v (effects/integrator.h)
//     c = (a0/dt)^2,    q_hat = (a1 q_n - a2 q_{n-1})/a0 + dt/a0^2 (a1 v_n - a2 v_{n-1}).
#include "effects/integrator.h"

namespace mortise::effects::inertia {

MORTISE_HD inline double c_of(const Integrator& in) { return in.a0 * in.a0 / (in.dt * in.dt); }
MORTISE_HD inline Vec3 q_hat(const Integrator& in, const Vec3& qn, const Vec3& qn1, const Vec3& vn, const Vec3& vn1) {
  return (in.a1 * qn - in.a2 * qn1) / in.a0 + in.dt / (in.a0 * in.a0) * (in.a1 * vn - in.a2 * vn1);
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
