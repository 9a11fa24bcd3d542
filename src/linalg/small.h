#pragma once
// Decompositions of small dense matrices that run inside kernels. They are ours because nvcc compiles Eigen's decompositions
// into code that does nothing. All are Jacobi methods: short, branch-light, and accurate to round-off.
#include <cmath>

#include "base/types.h"

namespace mortise::linalg {

template <int N>
using VecN = Eigen::Matrix<double, N, 1>;
template <int N>
using MatN = Eigen::Matrix<double, N, N>;

// Cyclic Jacobi iteration for symmetric A = Q diag(lambda) Q^T (Golub & Van Loan, Matrix Computations, 8.5). On return A is
// diagonal up to round-off: lambda_i = A(i, i), in no particular order; the columns of Q are the eigenvectors.
template <int N>
MORTISE_HD inline void jacobi_eigen(MatN<N>& A, MatN<N>& Q) {
  Q.setIdentity();
  const double small = 1e-17 * A.norm();
  for (int sweep = 0; sweep < 30; ++sweep) {
    bool rotated = false;
    for (int p = 0; p < N - 1; ++p)
      for (int q = p + 1; q < N; ++q) {
        const double apq = A(p, q);
        if (!(std::abs(apq) > small)) continue;
        rotated = true;
        // t = tan of the rotation that makes A(p, q) vanish, the smaller of the two
        const double theta = (A(q, q) - A(p, p)) / (2 * apq);
        const double t = (theta < 0 ? -1.0 : 1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < N; ++k) {
          const double akp = A(k, p), akq = A(k, q);
          A(k, p) = c * akp - s * akq;
          A(k, q) = s * akp + c * akq;
        }
        for (int k = 0; k < N; ++k) {
          const double apk = A(p, k), aqk = A(q, k);
          A(p, k) = c * apk - s * aqk;
          A(q, k) = s * apk + c * aqk;
        }
        A(p, q) = A(q, p) = 0;
        for (int k = 0; k < N; ++k) {
          const double qkp = Q(k, p), qkq = Q(k, q);
          Q(k, p) = c * qkp - s * qkq;
          Q(k, q) = s * qkp + c * qkq;
        }
      }
    if (!rotated) break;
  }
}

// The positive semi-definite matrix nearest (in the Frobenius norm) to symmetric H: negative eigenvalues become zero.
template <int N>
MORTISE_HD inline void project_psd(MatN<N>& H) {
  MatN<N> A = H, Q;
  jacobi_eigen<N>(A, Q);
  bool negative = false;
  for (int i = 0; i < N; ++i) negative = negative || A(i, i) < 0;
  if (!negative) return;
  for (int i = 0; i < N; ++i)
    for (int j = i; j < N; ++j) {
      double h = 0;
      for (int k = 0; k < N; ++k) h += A(k, k) > 0 ? Q(i, k) * A(k, k) * Q(j, k) : 0.0;
      H(i, j) = H(j, i) = h;
    }
}

// F = U diag(s) V^T with U and V rotations (determinant +1) and s0 >= s1 >= |s2|; s2 carries the sign of det F.
struct Svd3 {
  Mat3 U, V;
  Vec3 s;
};

// A unit vector perpendicular to the unit vector u.
MORTISE_HD inline Vec3 any_perpendicular(const Vec3& u) {
  const double x = std::abs(u[0]), y = std::abs(u[1]), z = std::abs(u[2]);
  const Vec3 e = x <= y && x <= z ? Vec3(1, 0, 0) : (y <= z ? Vec3(0, 1, 0) : Vec3(0, 0, 1));
  const Vec3 w = u.cross(e);
  return w / w.norm();
}

// One-sided Jacobi (Hestenes): rotate the columns of B = F V until they are perpendicular. Works on F itself, not on F^T F,
// so that the small singular values of a nearly flat element keep their digits.
MORTISE_HD inline Svd3 svd3(const Mat3& F) {
  Vec3 b[3] = {F.col(0), F.col(1), F.col(2)};
  Vec3 v[3] = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  constexpr double kTiny = 1e-32;  // cos^2 of the angle between columns that counts as perpendicular
  for (int sweep = 0; sweep < 20; ++sweep) {
    bool rotated = false;
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        const double alpha = b[p].dot(b[p]), beta = b[q].dot(b[q]), gamma = b[p].dot(b[q]);
        if (!(gamma * gamma > kTiny * alpha * beta)) continue;
        rotated = true;
        const double zeta = (beta - alpha) / (2 * gamma);
        const double t = (zeta < 0 ? -1.0 : 1.0) / (std::abs(zeta) + std::sqrt(zeta * zeta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        const Vec3 bp = b[p], vp = v[p];
        b[p] = c * bp - s * b[q];
        b[q] = s * bp + c * b[q];
        v[p] = c * vp - s * v[q];
        v[q] = s * vp + c * v[q];
      }
    if (!rotated) break;
  }
  // Longest column first; an exchange of two columns flips the sign of one, so that V stays a rotation.
  for (int pass = 0; pass < 3; ++pass) {
    const int i = pass == 1 ? 1 : 0;
    if (b[i].squaredNorm() < b[i + 1].squaredNorm()) {
      const Vec3 tb = b[i], tv = v[i];
      b[i] = b[i + 1], v[i] = v[i + 1];
      b[i + 1] = -tb, v[i + 1] = -tv;
    }
  }
  // U: normalised columns, completed where F is rank deficient.
  Svd3 r;
  const double s0 = b[0].norm();
  const Vec3 u0 = s0 > 0 ? Vec3(b[0] / s0) : Vec3(1, 0, 0);
  Vec3 w = b[1] - u0 * u0.dot(b[1]);
  const double s1 = w.norm();
  Vec3 u1 = s1 > 1e-300 ? Vec3(w / s1) : any_perpendicular(u0);
  w = u1 - u0 * u0.dot(u1);  // once more: a column that is mere round-off is not perpendicular after one pass
  const double l = w.norm();
  u1 = l > 0.5 ? Vec3(w / l) : any_perpendicular(u0);
  const Vec3 u2 = u0.cross(u1);
  r.U.col(0) = u0, r.U.col(1) = u1, r.U.col(2) = u2;
  r.V.col(0) = v[0], r.V.col(1) = v[1], r.V.col(2) = v[2];
  r.s = Vec3(s0, s1, u2.dot(b[2]));
  return r;
}

}  // namespace mortise::linalg
