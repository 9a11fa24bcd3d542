#pragma once
// A block matrix as a scalar one, both triangles, with rows and columns in another order: what a direct solver on the device takes.
#include <vector>

#include "linalg/block_matrix.h"

namespace mortise::linalg {

class ScalarCsr {
 public:
  // Row k of blocks is row order[k] of A. The structure is made on the host, once for a pattern.
  void set_pattern(const BlockMatrix& A, const std::vector<int>& order);
  void set_values(const BlockMatrix& A);
  // Vectors of A's order to this one and back.
  void to(View<const Vec3> v, View<double> out) const;
  void from(View<const double> v, View<Vec3> out) const;

  Index rows() const { return 3 * order_.size(); }
  const Buffer<Index>& row_start() const { return start_; }
  const Buffer<Index>& col() const { return col_; }
  const Buffer<double>& value() const { return value_; }

 private:
  Buffer<Index> order_, start_, col_, source_;  // source: of every entry, 9 * upper block + 3 * column + row
  Buffer<double> value_;
};

}  // namespace mortise::linalg
