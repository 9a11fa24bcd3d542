#pragma once
// Edge-edge mollifier (Li et al. 2020, "Incremental Potential Contact", eq. 24): the closest points of nearly parallel edges jump,
// so their energy is multiplied by
//     m(c) = (2 - c/eps) c/eps  for c < eps, else 1,    c = |u x v|^2,  u = a1 - a0,  v = b1 - b0,
// which is C1 and vanishes for parallel edges. eps = 1e-3 |u_rest|^2 |v_rest|^2 [m^4].
#include "base/types.h"

namespace mortise::geometry {

MORTISE_HD inline double mollifier_threshold(const Vec3 rest[4]) {
  return 1e-3 * (rest[1] - rest[0]).squaredNorm() * (rest[3] - rest[2]).squaredNorm();
}

// x = {a0, a1, b0, b1}.
MORTISE_HD inline double mollifier_argument(const Vec3 x[4]) { return (x[1] - x[0]).cross(x[3] - x[2]).squaredNorm(); }

MORTISE_HD inline double mollifier(const Vec3 x[4], double eps) {
  const double c = mollifier_argument(x);
  return c < eps ? (2 - c / eps) * c / eps : 1;
}

namespace detail {

//     dc/du = 2 (|v|^2 u - (u.v) v),   dc/dv = 2 (|u|^2 v - (u.v) u), written with cross products against cancellation.
MORTISE_HD inline Vec12 mollifier_argument_gradient(const Vec3 x[4]) {
  const Vec3 u = x[1] - x[0], v = x[3] - x[2], n = u.cross(v);
  const Vec3 cu = 2 * v.cross(n), cv = 2 * n.cross(u);
  Vec12 g;
  g.segment<3>(0) = -cu, g.segment<3>(3) = cu;
  g.segment<3>(6) = -cv, g.segment<3>(9) = cv;
  return g;
}

}  // namespace detail

MORTISE_HD inline Vec12 mollifier_gradient(const Vec3 x[4], double eps) {
  const double c = mollifier_argument(x);
  if (!(c < eps)) return Vec12::Zero();
  return (2 / eps) * (1 - c / eps) * detail::mollifier_argument_gradient(x);
}

//     Hess m = m' Hess c + m'' grad c grad c^T,    m' = 2/eps (1 - c/eps),   m'' = -2/eps^2
//     c_uu = 2 (|v|^2 I - v v^T),   c_vv = 2 (|u|^2 I - u u^T),   c_uv = 2 (2 u v^T - v u^T - (u.v) I)
MORTISE_HD inline Mat12 mollifier_hessian(const Vec3 x[4], double eps) {
  const double c = mollifier_argument(x);
  if (!(c < eps)) return Mat12::Zero();
  const Vec3 u = x[1] - x[0], v = x[3] - x[2];
  const Mat3 I = Mat3::Identity();
  const Mat3 uu = 2 * (v.squaredNorm() * I - v * v.transpose());
  const Mat3 vv = 2 * (u.squaredNorm() * I - u * u.transpose());
  const Mat3 uv = 2 * (2 * u * v.transpose() - v * u.transpose() - u.dot(v) * I);
  const Vec12 g = detail::mollifier_argument_gradient(x);
  const double first = 2 / eps * (1 - c / eps), second = -2 / (eps * eps);
  Mat12 H = second * g * g.transpose();
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      const double sign = i == j ? first : -first;
      H.block<3, 3>(3 * i, 3 * j) += sign * uu;
      H.block<3, 3>(6 + 3 * i, 6 + 3 * j) += sign * vv;
      H.block<3, 3>(3 * i, 6 + 3 * j) += sign * uv;
      H.block<3, 3>(6 + 3 * j, 3 * i) += sign * uv.transpose();
    }
  return H;
}

}  // namespace mortise::geometry
