#pragma once
// M^-1 for conjugate gradients: symmetric positive definite, block diagonal over environments like A.
#include "linalg/block_matrix.h"

namespace mortise::linalg {

class Preconditioner {
 public:
  virtual ~Preconditioner() = default;

  // Which environments the next build() is for; the others keep what they have.
  virtual void choose(const std::vector<std::uint8_t>& whose) = 0;
  // M for the values of A. `position` of every row [m]: current positions of nodes and of affine bodies, columns of the latter.
  virtual void build(const BlockMatrix& A, View<const Vec3> position) = 0;
  // z = M^-1 r. Launches kernels and does nothing else, so that it may be recorded into a graph.
  virtual void apply(View<const Vec3> r, View<Vec3> z) const = 0;

  // Per row: 1 where A was found not to be positive definite.
  virtual View<const Index> bad_rows() const = 0;
  // Where the memory lies that apply() uses; a recorded apply() may be replayed as long as this stays.
  virtual std::vector<const void*> memory() const = 0;
};

}  // namespace mortise::linalg
