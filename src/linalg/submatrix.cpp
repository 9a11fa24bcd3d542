#include "linalg/submatrix.h"

namespace mortise::linalg {

BlockMatrix& SubMatrix::of(const BlockMatrix& A, Index first, Index last) {
  if (A.pattern != from_ || first != first_ || last != last_) {
    from_ = A.pattern, first_ = first, last_ = last;
    std::vector<Index> start(last - first + 1);  // no more than its own part: there may be many
    device::copy_out(start.data(), A.row_start.view().p + first, start.size() * sizeof(Index));
    begin_ = start[0];
    std::vector<Index> col(start.back() - begin_);
    if (!col.empty()) device::copy_out(col.data(), A.col.view().p + begin_, col.size() * sizeof(Index));
    std::vector<std::uint64_t> keys;
    for (Index r = 0; r < last - first; ++r)
      for (Index k = start[r]; k < start[r + 1]; ++k) keys.push_back(block_key(r, col[k - begin_] - first, last - first));
    if (keys != keys_ || matrix_.rows != last - first) set_pattern(Buffer<std::uint64_t>(keys), last - first, matrix_);
    keys_ = std::move(keys);
  }
  device::copy(matrix_.value.view().p, A.value.view().p + begin_, static_cast<std::size_t>(matrix_.value.size()) * sizeof(Mat3));
  return matrix_;
}

}  // namespace mortise::linalg
