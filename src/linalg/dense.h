#pragma once
// Small dense systems on the host. Eigen's decompositions of matrices of dynamic size do not compile under nvcc's rules for calls between host and
// device.
#include <cmath>
#include <utility>
#include <vector>

#include "base/types.h"

namespace mortise::linalg {

// Row by row.
struct DenseMatrix {
  Index rows = 0, cols = 0;
  std::vector<double> value;
  DenseMatrix(Index rows_, Index cols_) : rows(rows_), cols(cols_), value(static_cast<std::size_t>(rows_) * cols_, 0.0) {}
  double& operator()(Index i, Index j) { return value[static_cast<std::size_t>(i) * cols + j]; }
  double operator()(Index i, Index j) const { return value[static_cast<std::size_t>(i) * cols + j]; }
};

// X of A X = B, by elimination with the largest pivot of every column.
inline DenseMatrix solve(DenseMatrix A, DenseMatrix B) {
  for (Index k = 0; k < A.rows; ++k) {
    Index best = k;
    for (Index i = k + 1; i < A.rows; ++i)
      if (std::abs(A(i, k)) > std::abs(A(best, k))) best = i;
    for (Index j = 0; j < A.cols; ++j) std::swap(A(k, j), A(best, j));
    for (Index j = 0; j < B.cols; ++j) std::swap(B(k, j), B(best, j));
    for (Index i = 0; i < A.rows; ++i) {
      if (i == k || A(i, k) == 0) continue;
      const double factor = A(i, k) / A(k, k);
      for (Index j = k; j < A.cols; ++j) A(i, j) -= factor * A(k, j);
      for (Index j = 0; j < B.cols; ++j) B(i, j) -= factor * B(k, j);
    }
  }
  for (Index k = 0; k < A.rows; ++k)
    for (Index j = 0; j < B.cols; ++j) B(k, j) /= A(k, k);
  return B;
}

}  // namespace mortise::linalg
