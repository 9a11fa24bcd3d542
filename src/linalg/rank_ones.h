#pragma once
// Unsymmetric pieces of a Jacobian beside the stencils of a set: J(a,b) += sum_c l_ca r_cb^T over the blocks a, b of the stencil, c < rank.
#include "linalg/stencils.h"

namespace mortise::linalg {

struct RankOnes {
  Index rank = 0;
  device::Buffer<Vec3> left, right;  // rank times the blocks of the set, c by c; units of the products: [N/m]
  void resize(Index rank_, Index blocks) { rank = rank_, left.resize(rank * blocks), right.resize(rank * blocks); }
  bool any() const { return left.size() > 0; }
  std::size_t bytes() const { return left.bytes() + right.bytes(); }
};

// Overwrites the set's gradient pieces by sum_c l_c (r_c . d), transposed by sum_c r_c (l_c . d): assembling them gives the product.
void multiply(const RankOnes& pieces, bool transposed, device::View<const Vec3> d, StencilSet& set);

}  // namespace mortise::linalg
