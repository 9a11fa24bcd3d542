#include "linalg/submatrix.h"

namespace mortise::linalg {

BlockMatrix& SubMatrix::of(const BlockMatrix& A, Index first, Index last) {
  if (A.pattern != from_ || first != first_ || last != last_) {
    from_ = A.pattern, first_ = first, last_ = last;
    const std::vector<Index> start = A.row_start.download(), col = A.col.download();
    begin_ = start[first];
    std::vector<std::uint64_t> keys;
    for (Index r = first; r < last; ++r)
      for (Index k = start[r]; k < start[r + 1]; ++k) keys.push_back(block_key(r - first, col[k] - first, last - first));
    if (keys != keys_ || matrix_.rows != last - first) set_pattern(Buffer<std::uint64_t>(keys), last - first, matrix_);
    keys_ = std::move(keys);
  }
  device::copy(matrix_.value.view().p, A.value.view().p + begin_, static_cast<std::size_t>(matrix_.value.size()) * sizeof(Mat3));
  return matrix_;
}

}  // namespace mortise::linalg
