#pragma once
// The displacements of a model in another of the same bodies on richer meshes: tetrahedra with nodes in the middles of their edges, where the first
// has none, or surfaces of stiff bodies with more facets. A node in the middle moves as the mean of the two at the ends,
//
//   q' = Q' + sum_k w_k (q_k - Q_k),   Q, Q' at rest.
#include "model/model.h"

namespace mortise::solver {

class Lift {
 public:
  // Throws Error(Exit::usage) where bodies are not the same, or meshes of `to` are none of those.
  Lift(const model::Model& from, const model::Model& to);
  void apply(device::View<const Vec3> q, device::Buffer<Vec3>& out) const;

 private:
  device::Buffer<Index> first_, second_;  // per block of `to`: blocks of `from`, the same where there is one
  device::Buffer<Vec3> at_rest_;          // Q' - sum_k w_k Q_k
};

}  // namespace mortise::solver
