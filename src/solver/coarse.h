#pragma once
// An approximate inverse on richer meshes: what the equations of a step are on the meshes that they were made from. With the blocks of the diagonal, which see
// what only the richer meshes do, conjugate gradients take a number of iterations that does not grow with the mesh (hierarchical bases: Bank, Dupont,
// Yserentant, Numer. Math. 52, 1988).
#include "solver/lift.h"
#include "solver/system.h"

namespace mortise::solver {

class Tangent;

class Coarse {
 public:
  // All outlive it. `tangent` of `from` is linearised, by a factor.
  Coarse(System& from, Tangent& tangent, System& to, const Lift& lift) : from_(from), tangent_(tangent), to_(to), lift_(lift) {}
  // out += N A^-1 N^T in, on the rows of the richer meshes.
  void add(device::View<const Vec3> in, device::View<Vec3> out);

 private:
  System& from_;
  Tangent& tangent_;
  System& to_;
  const Lift& lift_;
  device::Buffer<Vec3> there_, here_, f_, x_;  // work space
};

}  // namespace mortise::solver
