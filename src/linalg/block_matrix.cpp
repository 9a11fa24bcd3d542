#include "linalg/block_matrix.h"

#include <atomic>
#include <bit>

namespace mortise::linalg {
namespace {

// start[r] = first place in the ascending list `id` with id >= r, for r = 0..rows.
void starts_of(View<const Index> id, Index rows, Buffer<Index>& start) {
  start.resize(rows + 1);
  const View<Index> s = start.view();
  const Index n = id.n;
  device::parallel_for("matrix.starts", n + 1, [=] MORTISE_HD(Index k) {
    const Index first = k == 0 ? 0 : id[k - 1] + 1;
    const Index last = k == n ? rows : id[k];
    for (Index r = first; r <= last; ++r) s[r] = k;
  });
}

}  // namespace

void set_pattern(const Buffer<std::uint64_t>& keys, Index rows, BlockMatrix& A) {
  static std::atomic<std::uint64_t> last{0};
  A.pattern = ++last;
  A.rows = rows;
  const Index n = keys.size();
  A.row.resize(n), A.col.resize(n), A.value.resize(n);
  const View<const std::uint64_t> key = keys.view();
  const View<Index> row = A.row.view(), col = A.col.view();
  device::parallel_for("matrix.unpack", n, [=] MORTISE_HD(Index k) {
    row[k] = static_cast<Index>(key[k] / static_cast<std::uint64_t>(rows));
    col[k] = static_cast<Index>(key[k] % static_cast<std::uint64_t>(rows));
  });
  starts_of(row, rows, A.row_start);

  // The lower blocks of row c are the upper blocks of column c: a stable sort by column keeps them in row order. Diagonal
  // blocks sort behind all columns and drop out.
  Buffer<std::uint64_t> by_column(n);
  Buffer<Index> order(n);
  const View<std::uint64_t> bc = by_column.view();
  const View<Index> o = order.view();
  device::parallel_for("matrix.columns", n, [=] MORTISE_HD(Index k) {
    bc[k] = static_cast<std::uint64_t>(row[k] == col[k] ? rows : col[k]);
    o[k] = k;
  });
  device::sort_pairs(by_column, order, std::bit_width(static_cast<std::uint64_t>(rows)));
  const Index lower = n - rows;
  Buffer<Index> lower_row(lower), lower_start;
  const View<const std::uint64_t> sorted = by_column.view();
  const View<Index> lr = lower_row.view();
  device::parallel_for("matrix.columns", lower, [=] MORTISE_HD(Index j) { lr[j] = static_cast<Index>(sorted[j]); });
  starts_of(lr, rows, lower_start);

  A.full_start.resize(rows + 1);
  A.full_col.resize(n + lower);
  A.full_source.resize(n + lower);
  const View<const Index> us = A.row_start.view(), ls = lower_start.view(), from = order.view();
  const View<Index> fs = A.full_start.view(), fc = A.full_col.view(), source = A.full_source.view();
  device::parallel_for("matrix.full", rows + 1, [=] MORTISE_HD(Index r) {
    Index at = us[r] + ls[r];
    fs[r] = at;
    if (r == rows) return;
    for (Index j = ls[r]; j < ls[r + 1]; ++j, ++at) fc[at] = row[from[j]], source[at] = ~from[j];
    for (Index k = us[r]; k < us[r + 1]; ++k, ++at) fc[at] = col[k], source[at] = k;
  });
}

void multiply(const BlockMatrix& A, View<const Vec3> x, View<Vec3> y) { multiply(A, x, device::Ranges{0, A.rows}, y); }

void multiply(const BlockMatrix& A, View<const Vec3> x, const device::Ranges& rows, View<Vec3> y) {
  Buffer<Index> memory;
  const device::Places place = rows.places(memory);
  row_product(A)("matrix.multiply", rows.size(), x, place, [=] MORTISE_HD(Index k, const Vec3& y_k) { y[place(k)] = y_k; });
}

}  // namespace mortise::linalg
