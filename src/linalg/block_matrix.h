#pragma once
// Symmetric sparse matrix of 3x3 blocks. Stored once: the blocks of the upper triangle (row <= column), sorted by row, then
// column; every row has its diagonal block, so a row's first block is the diagonal one. For y = A x there is also the full
// structure of every row, as places in the upper values, so that a product only gathers and always adds in column order.
#include "device/device.h"

namespace mortise::linalg {

using device::Buffer;
using device::View;

struct BlockMatrix {
  Index rows = 0;
  std::uint64_t pattern = 0;  // equal numbers mean equal structure; 0 = none

  Buffer<Index> row_start;  // rows + 1: row r has the upper blocks [row_start[r], row_start[r+1])
  Buffer<Index> row, col;   // of every upper block
  Buffer<Mat3> value;       // [N/m] for a Hessian

  Buffer<Index> full_start;   // rows + 1
  Buffer<Index> full_col;     // ascending within a row
  Buffer<Index> full_source;  // k >= 0: value[k]; otherwise value[~k] transposed

  Index upper_blocks() const { return value.size(); }
};

// Key of an upper block; ascending keys are row-major order.
MORTISE_HD inline std::uint64_t block_key(Index row, Index col, Index rows) {
  return static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(rows) + static_cast<std::uint64_t>(col);
}

// Gives A the structure of the sorted, distinct `keys` (block_key), which must contain every diagonal block, and the next
// unused pattern number. Values are left undefined.
void set_pattern(const Buffer<std::uint64_t>& keys, Index rows, BlockMatrix& A);

// Rows of A x.
struct RowProduct {
  View<const Index> start, col, source;
  View<const Mat3> value;
  // What the places [from, to) of the full structure add to their row.
  MORTISE_HD Vec3 sum(Index from, Index to, View<const Vec3> x) const {
    Vec3 y = Vec3::Zero();
    for (Index j = from; j < to; ++j) {
      const Index k = source[j];
      if (k >= 0)
        y += value[k] * x[col[j]];
      else
        y += value[~k].transpose() * x[col[j]];
    }
    return y;
  }
  // put(k, row row_of(k) of A x) for k = 0 .. n - 1; of none where row_of(k) is negative.
  template <class RowOf, class Put>
  void operator()(const char* name, Index n, View<const Vec3> x, RowOf row_of, Put put) const {
    const RowProduct A = *this;
    if constexpr (device::kHostThreads) {  // of which each has a row anyway
      device::parallel_for(name, n, [=](Index k) {
        const Index i = row_of(k);
        if (i >= 0) put(k, A.sum(A.start[i], A.start[i + 1], x));
      });
    } else {
      device::fold(
          name, n,
          [=] MORTISE_HD(Index k, Index & from, Index & to) {
            const Index i = row_of(k);
            if (i >= 0) from = A.start[i], to = A.start[i + 1];
          },
          [=] MORTISE_HD(Index j) { return A.sum(j, j + 1, x); }, device::AddUp<Vec3>(),
          [=] MORTISE_HD(Index k, const Vec3& y) {
            if (row_of(k) >= 0) put(k, y);
          });
    }
  }
};
inline RowProduct row_product(const BlockMatrix& A) { return {A.full_start.view(), A.full_col.view(), A.full_source.view(), A.value.view()}; }

// y = A x, in all rows or in some; x and y must not overlap.
void multiply(const BlockMatrix& A, View<const Vec3> x, View<Vec3> y);
void multiply(const BlockMatrix& A, View<const Vec3> x, const device::Ranges& rows, View<Vec3> y);

}  // namespace mortise::linalg
