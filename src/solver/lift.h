#pragma once
// The displacements of a model in another of the same bodies on richer meshes, where they are the same functions:
//
//   q' = Q' + N (q - Q),   Q, Q' at rest,
//
// with the shape functions of the elements of the first at the nodes of the second. Meshes are richer where tetrahedra have nodes in the middles of their
// edges too, where quadratic ones are cut into eight (geometry/refine.h), and where surfaces of stiff bodies have other facets.
#include <utility>
#include <vector>

#include "model/model.h"

namespace mortise::solver {

class Lift {
 public:
  // Throws Error(Exit::usage) where bodies are not the same, or meshes of `to` are none of those.
  Lift(const model::Model& from, const model::Model& to);
  void apply(device::View<const Vec3> q, device::Buffer<Vec3>& out) const;
  // d' = N d of a displacement, and f = N^T f' of forces.
  void along(device::View<const Vec3> d, device::Buffer<Vec3>& out) const;
  void transposed(device::View<const Vec3> f, device::Buffer<Vec3>& out) const;

 private:
  struct Rows {
    std::vector<std::vector<std::pair<Index, double>>> of;  // while they are made
    device::Buffer<Index> offset, block;
    device::Buffer<double> weight;
    void upload();
    void product(device::View<const Vec3> x, device::View<const Vec3> plus, device::Buffer<Vec3>& out) const;
  };
  Rows N_, transposed_;           // rows of N, and of N^T
  device::Buffer<Vec3> at_rest_;  // Q' - N Q
};

}  // namespace mortise::solver
