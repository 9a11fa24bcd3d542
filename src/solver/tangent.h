#pragma once
// The Jacobian of a step's equations at its solution, J = P T^T (d grad Phi / dq) T P with everything fresh, as a matrix to solve with:
//
//   J x = f     how the solution moves where forces f [N] act besides,
//   J^T x = f   its adjoint: what a functional with the gradient f would change by per newton at every block [.../N].
//
// J is H + U with what moves (potential.h), solved by GMRES with a factor of H. Where an effect says that something is missing
// (Effect::complete) products J v are central differences of forces; J^T lacks those terms then, which is good enough for estimates.
#include <memory>

#include "solver/linear.h"
#include "solver/system.h"

namespace mortise::solver {

class Tangent {
 public:
  // Of a model with one environment. What the system's own solver keeps stays as it is.
  explicit Tangent(System& system);

  // J at q, within the step that the effects have begun. Throws Failure where no factor can be made.
  void linearise(const device::Buffer<Vec3>& q);
  // -P grad Phi there, on the rows.
  const device::Buffer<Vec3>& forces() const { return forces_; }
  // The effects there, sampled.
  const Linearised& at() const { return at_; }
  // Are all of its terms assembled? Else J^T is not all of it.
  bool assembled() const { return assembled_; }

  // T^T J d, or T^T J^T d, over all blocks, without P.
  void product(device::View<const Vec3> d, bool transposed, device::Buffer<Vec3>& out);
  // x on the rows. Throws Failure where it does not converge.
  void solve(device::View<const Vec3> f, bool transposed, device::Buffer<Vec3>& x);

 private:
  System& system_;
  std::unique_ptr<Linear> linear_;
  Linearised at_, beside_;
  linalg::BlockMatrix matrix_;
  bool assembled_ = true;
  device::Buffer<Vec3> q_, forces_, moved_;  // of the state; work space
};

}  // namespace mortise::solver
