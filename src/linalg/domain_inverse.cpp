#include "linalg/domain_inverse.h"

#include <cmath>

namespace mortise::linalg {
namespace {

constexpr double kLost = 1e-12;  // pivots below this share of their size are rounding

// 1 / sqrt(pivot), or 0 to leave the unknown out.
MORTISE_HD inline double pivot_root(double pivot, double size, bool strict, bool& good) {
  if (pivot > kLost * size) return 1 / std::sqrt(pivot);
  if (!strict) return 0;
  if (!(size > 0) || !(pivot > -kLost * size)) {
    good = false;
    return 0;
  }
  return 1 / std::sqrt(size);
}

// Inverse of the lower triangular L with S = L L^T.
MORTISE_HD inline Mat3 inverse_of_factor(const Mat3& S, const Vec3& size, bool strict, bool& good) {
  Mat3 M = Mat3::Zero();
  const double i0 = pivot_root(S(0, 0), size[0], strict, good);
  const double l10 = S(1, 0) * i0, l20 = S(2, 0) * i0;
  const double i1 = pivot_root(S(1, 1) - l10 * l10, size[1], strict, good);
  const double l21 = (S(2, 1) - l20 * l10) * i1;
  const double i2 = pivot_root(S(2, 2) - l20 * l20 - l21 * l21, size[2], strict, good);
  M(0, 0) = i0, M(1, 1) = i1, M(2, 2) = i2;
  M(1, 0) = -i1 * l10 * i0;
  M(2, 1) = -i2 * l21 * i1;
  M(2, 0) = -i2 * (l20 * i0 + l21 * M(1, 0));
  return M;
}

// L_jj^-1 from S_jj, which the diagonal block holds once all columns before j are done.
MORTISE_HD inline void take_pivot(View<Mat3> lower, View<const Vec3> size, Index d, Index j, bool strict, View<Mat3> pivot, View<Index> bad) {
  bool good = true;
  pivot[d * kSlots + j] = inverse_of_factor(lower[d * kPacked + packed_place(j, j)], size[d * kSlots + j], strict, good);
  if (!good) bad[d] = 1;
}

void first_pivots(DomainMatrices& m) {
  const View<Mat3> lower = m.lower.view(), pivot = m.pivot.view();
  const View<const Vec3> size = m.size.view();
  const View<Index> bad = m.bad.view();
  const Index strict_domains = m.strict_domains;
  device::parallel_for("domains.factor", m.domains, [=] MORTISE_HD(Index d) {
    bad[d] = 0;
    take_pivot(lower, size, d, 0, d < strict_domains, pivot, bad);
  });
}

// Block column j of all factors, a thread for every row i below it:
//   L_ij = (A_ij - sum_{k<j} L_ik L_jk^T) L_jj^-T,   S_ii <- S_ii - L_ij L_ij^T,   and the next pivot where i = j + 1.
void factor_column(DomainMatrices& m, Index j) {
  const View<const Index> blocks = m.blocks.view();
  const View<Mat3> lower = m.lower.view(), pivot = m.pivot.view();
  const View<const Vec3> size = m.size.view();
  const View<Index> bad = m.bad.view();
  const Index strict_domains = m.strict_domains, rows = kSlots - 1 - j;
  device::parallel_for("domains.factor", m.domains * rows, [=] MORTISE_HD(Index t) {
    const Index d = t / rows, i = j + 1 + t % rows;
    if (i >= blocks[d]) return;
    const Index at = d * kPacked;
    Mat3 S = lower[at + packed_place(i, j)];
    for (Index k = 0; k < j; ++k) S -= lower[at + packed_place(i, k)] * lower[at + packed_place(j, k)].transpose();
    const Mat3 L = S * pivot[d * kSlots + j].transpose();
    lower[at + packed_place(i, j)] = L;
    lower[at + packed_place(i, i)] -= L * L.transpose();
    if (i == j + 1) take_pivot(lower, size, d, i, d < strict_domains, pivot, bad);
  });
}

// X_jj = L_jj^-1,  X_ij = -L_ii^-1 sum_{j<=k<i} L_ik X_kj
void invert_factors(DomainMatrices& m) {
  const View<const Index> blocks = m.blocks.view();
  const View<const Mat3> lower = m.lower.view(), pivot = m.pivot.view();
  const View<Mat3f> inverse = m.inverse.view();
  device::parallel_for("domains.invert", m.domains * kSlots, [=] MORTISE_HD(Index t) {
    const Index d = t / kSlots, j = t % kSlots;
    const Index at = d * kPacked;
    Mat3 X[kSlots];
    for (Index i = j; i < blocks[d]; ++i) {
      const Mat3 Lii = pivot[d * kSlots + i];
      if (i == j) {
        X[i] = Lii;
      } else {
        Mat3 S = Mat3::Zero();
        for (Index k = j; k < i; ++k) S += lower[at + packed_place(i, k)] * X[k];
        X[i] = -(Lii * S);
      }
      inverse[at + packed_place(i, j)] = X[i].cast<float>();
    }
  });
}

}  // namespace

void DomainMatrices::resize(const Domains& of) {
  domains = static_cast<Index>(of.blocks.size()), strict_domains = of.fine;
  blocks.upload(of.blocks);
  lower.resize(domains * kPacked), inverse.resize(domains * kPacked);
  size.resize(domains * kSlots), pivot.resize(domains * kSlots);
  bad.resize(domains);
}

void DomainMatrices::invert() {
  first_pivots(*this);
  for (Index j = 0; j + 1 < kSlots; ++j) factor_column(*this, j);
  invert_factors(*this);
}

}  // namespace mortise::linalg
