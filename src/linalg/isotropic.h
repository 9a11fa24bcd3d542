#pragma once
// Second derivative of an isotropic energy density psi(s0, s1, s2) of F = U diag(s) V^T, by its nine eigenmodes, in closed
// form (Smith, de Goes, Kim, "Analytic Eigensystems for Isotropic Distortion Energies", ACM TOG 38(1), 2019, section 4):
//   twist in the plane (i, j): U (e_i e_j^T - e_j e_i^T) V^T / sqrt 2,  eigenvalue (psi_i + psi_j) / (s_i + s_j),
//   flip  in the plane (i, j): U (e_i e_j^T + e_j e_i^T) V^T / sqrt 2,  eigenvalue (psi_i - psi_j) / (s_i - s_j),
//   three stretches U diag(z) V^T, with z and the eigenvalues those of the 3x3 matrix d^2 psi / ds_i ds_j.
// Clamping these eigenvalues at zero projects the 9x9 matrix d^2 psi / dF^2 to the nearest positive semi-definite one; scaling the
// negative ones by a share between 0 and 1 leads from there to the exact matrix.
#include "linalg/small.h"

namespace mortise::linalg {

struct IsotropicModes {
  Mat3 U, V;
  Vec3 twist, flip;  // entry k belongs to the plane of the two other axes
  Mat3 stretch;
};

// Is the symmetric matrix positive definite, beyond the reach of rounding? By its pivots.
MORTISE_HD inline bool clearly_positive(const Mat3& A) {
  const double least = 1e-12 * A.trace();
  const double l10 = A(1, 0) / A(0, 0), l20 = A(2, 0) / A(0, 0), d1 = A(1, 1) - l10 * A(1, 0), e = A(2, 1) - l20 * A(1, 0);
  return A(0, 0) > least && d1 > least && A(2, 2) - l20 * A(2, 0) - e * e / d1 > least;
}

// Keeps the share `concave` of the negative curvature.
MORTISE_HD inline void scale_concave(IsotropicModes& m, double concave) {
  for (int k = 0; k < 3; ++k) {
    m.twist[k] = m.twist[k] > 0 ? m.twist[k] : concave * m.twist[k];
    m.flip[k] = m.flip[k] > 0 ? m.flip[k] : concave * m.flip[k];
  }
  if (clearly_positive(m.stretch)) return;
  Mat3 convex = m.stretch;
  project_psd<3>(convex);
  m.stretch = convex + concave * (m.stretch - convex);
}

// With F = sum_a x_a g_a^T and h_a = V^T g_a: the 3x3 piece d^2 psi / dx_a dx_b = U K U^T, where K sums lambda_m (D_m h_a)(D_m h_b)^T
// over the modes U D_m V^T.
MORTISE_HD inline Mat3 hessian_block(const IsotropicModes& m, const Vec3& ha, const Vec3& hb) {
  Mat3 K;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) K(i, j) = m.stretch(i, j) * ha[i] * hb[j];
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double mean = 0.5 * (m.flip[k] + m.twist[k]), half = 0.5 * (m.flip[k] - m.twist[k]);
    K(i, i) += mean * ha[j] * hb[j];
    K(j, j) += mean * ha[i] * hb[i];
    K(i, j) += half * ha[j] * hb[i];
    K(j, i) += half * ha[i] * hb[j];
  }
  return m.U * K * m.U.transpose();
}

}  // namespace mortise::linalg
