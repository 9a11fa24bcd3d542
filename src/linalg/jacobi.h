#pragma once
// Block Jacobi: the inverses of the 3x3 diagonal blocks.
#include "linalg/preconditioner.h"

namespace mortise::linalg {

class BlockJacobi : public Preconditioner {
 public:
  // Environment e owns rows [env_rows[e], env_rows[e+1]).
  explicit BlockJacobi(const std::vector<Index>& env_rows);

  void choose(const std::vector<std::uint8_t>& whose) override { whose_ = whose; }
  void build(const BlockMatrix& A, View<const Vec3> position = {}) override;
  void apply(View<const Vec3> r, View<Vec3> z) const override;
  View<const Index> bad_rows() const override { return bad_.view(); }
  std::vector<const void*> memory() const override { return {inverse_.view().p}; }

 private:
  std::vector<Index> env_rows_;
  std::vector<std::uint8_t> whose_;
  Buffer<Mat3> inverse_;
  Buffer<Index> bad_;
};

}  // namespace mortise::linalg
