#pragma once
// The rows [first, last) of a block-diagonal matrix as a matrix of their own, for solvers that must not know the rest.
#include "linalg/block_matrix.h"

namespace mortise::linalg {

class SubMatrix {
 public:
  // Stands until the next call; its pattern stays while the structure of these rows does.
  BlockMatrix& of(const BlockMatrix& A, Index first, Index last);

 private:
  BlockMatrix matrix_;
  std::uint64_t from_ = 0;  // A's pattern
  Index first_ = -1, last_ = -1, begin_ = 0;
  std::vector<std::uint64_t> keys_;
};

}  // namespace mortise::linalg
