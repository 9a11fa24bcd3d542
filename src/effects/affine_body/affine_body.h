#pragma once
// Stiff bodies as affine bodies (Lan, Kaufman, Li, Jiang, Yang: "Affine Body Dynamics", 2022): A = [a1 a2 a3] is kept close to
// a rotation by the orthogonality energy (their eq. 7)
//     E = V k |A^T A - I|_F^2  [J],      V body volume [m^3],  k stiffness [Pa],
//     dE/da_i = 4 V k (column i of A (A^T A - I)) [N].
// In the singular values psi = k sum (s_i^2 - 1)^2, so psi_i = 4 k s_i (s_i^2 - 1) and the eigenvalues of d^2 psi/dA^2 are
//     twist_ij = 4 k (s_i^2 - s_i s_j + s_j^2 - 1),   flip_ij = 4 k (s_i^2 + s_i s_j + s_j^2 - 1),   psi_ii = 4 k (3 s_i^2 - 1).
#include "base/rotation.h"
#include "linalg/isotropic.h"

namespace mortise::effects::affine_body {

MORTISE_HD inline Mat3 defect(const Mat3& A) {
  Mat3 D = A.transpose() * A;
  D.diagonal() -= Vec3(1, 1, 1);
  return D;
}
MORTISE_HD inline double energy(double Vk, const Mat3& A) { return Vk * defect(A).squaredNorm(); }
// Column i is dE/da_i.
MORTISE_HD inline Mat3 gradient(double Vk, const Mat3& A) { return 4 * Vk * (A * defect(A)); }

// What A + dA is turned by to first order [rad]: the axis of W, the skew part of dA A^T, A being close to a rotation.
MORTISE_HD inline Vec3 turn(const Mat3& A, const Mat3& dA) {
  const Mat3 L = dA * A.transpose();
  return 0.5 * Vec3(L(2, 1) - L(1, 2), L(0, 2) - L(2, 0), L(1, 0) - L(0, 1));
}
// The way on an arc instead, dA + (exp W - I - W) A, exp W = I + sin t/t W + (1 - cos t)/t^2 W^2 (Rodrigues), t = |w| [rad]. Both factors are summed
// as series in t^2, as libraries' sines differ in their last bits between devices (base/math.h): to rounding for t < 4.
MORTISE_HD inline Mat3 bent(const Mat3& A, const Mat3& dA, const Vec3& w) {
  constexpr int kTerms = 16;
  const double z = w.squaredNorm();
  double sine = 0, cosine = 0;  // sin t/t - 1, 2 (1 - cos t)/t^2 - 1
  for (int n = kTerms; n > 0; --n) {
    sine = -z / (2 * n * (2 * n + 1)) * (1 + sine);
    cosine = -z / ((2 * n + 1) * (2 * n + 2)) * (1 + cosine);
  }
  const Mat3 W = cross_matrix(w), WA = W * A;
  return dA + sine * WA + 0.5 * (1 + cosine) * (W * WA);
}

MORTISE_HD inline linalg::IsotropicModes modes(const Mat3& A) {
  const linalg::Svd3 d = linalg::svd3(A);
  const Vec3& s = d.s;
  linalg::IsotropicModes m;
  m.U = d.U, m.V = d.V;
  m.stretch.setZero();
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double squares = s[i] * s[i] + s[j] * s[j] - 1, product = s[i] * s[j];
    m.twist[k] = 4 * (squares - product);
    m.flip[k] = 4 * (squares + product);
    m.stretch(k, k) = 4 * (3 * s[k] * s[k] - 1);
  }
  return m;
}
// hess[6]: upper triangle of the pieces d^2 E/da_i da_j, row by row [N], with the share `concave` of its negative curvature.
MORTISE_HD inline void hessian(double Vk, const Mat3& A, double concave, Mat3* hess) {
  linalg::IsotropicModes m = modes(A);
  linalg::scale_concave(m, concave);
  const Mat3 h = m.V.transpose();  // column a is V^T e_a
  for (int a = 0, place = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b) hess[place++] = Vk * linalg::hessian_block(m, h.col(a), h.col(b));
}

}  // namespace mortise::effects::affine_body
