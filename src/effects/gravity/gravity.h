#pragma once
// Potential of a uniform gravitational field. Block i carries the force f_i = sum_j m_ij g_j [N], with g_j the acceleration for
// position blocks and zero for the columns of affine bodies (their first moment about the centre of mass vanishes).
//     E = -sum_i f_i . (q_i - rest_i) [J],    gradient -f_i,    no Hessian.
// Counted from rest, so that the energy of a small motion keeps its digits.
#include "base/types.h"

namespace mortise::effects::gravity {

MORTISE_HD inline double energy(const Vec3& f, const Vec3& q, const Vec3& rest) { return -f.dot(q - rest); }
MORTISE_HD inline Vec3 gradient(const Vec3& f) { return -f; }

}  // namespace mortise::effects::gravity
