#pragma once
// The displacements of a model in another of the same bodies on richer meshes, where they are the same functions:
//
//   q' = Q' + sum_k N_k (q_k - Q_k),   Q, Q' at rest,
//
// with the shape functions N of the element of the first at the node of the second. Meshes are richer where tetrahedra have nodes in the middles of their
// edges too, where quadratic ones are cut into eight (geometry/refine.h), and where surfaces of stiff bodies have other facets.
#include "model/model.h"

namespace mortise::solver {

class Lift {
 public:
  // Throws Error(Exit::usage) where bodies are not the same, or meshes of `to` are none of those.
  Lift(const model::Model& from, const model::Model& to);
  void apply(device::View<const Vec3> q, device::Buffer<Vec3>& out) const;

 private:
  device::Buffer<Index> offset_, block_;  // per block of `to`: those of `from`,
  device::Buffer<double> weight_;         // and N there
  device::Buffer<Vec3> at_rest_;          // Q' - sum_k N_k Q_k
};

}  // namespace mortise::solver
