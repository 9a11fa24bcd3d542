#include "linalg/jacobi.h"

#include <cmath>

namespace mortise::linalg {
namespace {

// Inverse of a symmetric positive definite A = L L^T as L^-T L^-1, which stays positive definite in rounding. False when a
// pivot is not positive.
MORTISE_HD inline bool spd_inverse(const Mat3& A, Mat3& out) {
  const double d0 = A(0, 0);
  if (!(d0 > 0)) return false;
  const double l00 = std::sqrt(d0), l10 = A(0, 1) / l00, l20 = A(0, 2) / l00;
  const double d1 = A(1, 1) - l10 * l10;
  if (!(d1 > 0)) return false;
  const double l11 = std::sqrt(d1), l21 = (A(1, 2) - l20 * l10) / l11;
  const double d2 = A(2, 2) - l20 * l20 - l21 * l21;
  if (!(d2 > 0)) return false;
  const double l22 = std::sqrt(d2);
  Mat3 M = Mat3::Zero();  // L^-1
  M(0, 0) = 1 / l00, M(1, 1) = 1 / l11, M(2, 2) = 1 / l22;
  M(1, 0) = -l10 * M(0, 0) / l11;
  M(2, 1) = -l21 * M(1, 1) / l22;
  M(2, 0) = -(l20 * M(0, 0) + l21 * M(1, 0)) / l22;
  out = M.transpose() * M;
  return true;
}

}  // namespace

BlockJacobi::BlockJacobi(const std::vector<Index>& env_rows) : env_rows_(env_rows), inverse_(env_rows.back()), bad_(env_rows.back()) {
  inverse_.zero(), bad_.zero();
}

void BlockJacobi::build(const BlockMatrix& A, View<const Vec3>) {
  const View<const Index> diagonal = A.row_start.view();
  const View<const Mat3> value = A.value.view();
  const View<Mat3> inverse = inverse_.view();
  const View<Index> bad = bad_.view();
  device::parallel_for("jacobi.invert", device::Ranges(env_rows_, whose_), [=] MORTISE_HD(Index i) {
    bad[i] = spd_inverse(value[diagonal[i]], inverse[i]) ? 0 : 1;
    if (bad[i]) inverse[i].setZero();  // apply() may come before anybody has looked
  });
}

void BlockJacobi::apply(View<const Vec3> r, View<Vec3> z) const {
  const View<const Mat3> inverse = inverse_.view();
  device::parallel_for("jacobi.apply", r.n, [=] MORTISE_HD(Index i) { z[i] = inverse[i] * r[i]; });
}

}  // namespace mortise::linalg
