#pragma once
// Block Jacobi: the inverses of the 3x3 diagonal blocks.
#include "linalg/preconditioner.h"

namespace mortise::linalg {

class BlockJacobi : public Preconditioner {
 public:
  void build(const BlockMatrix& A, View<const Vec3> position = {}) override;
  void apply(View<const Vec3> r, View<Vec3> z) const override;
  View<const Index> bad_rows() const override { return bad_.view(); }
  std::vector<const void*> memory() const override { return {inverse_.view().p}; }

 private:
  Buffer<Mat3> inverse_;
  Buffer<Index> bad_;
};

}  // namespace mortise::linalg
