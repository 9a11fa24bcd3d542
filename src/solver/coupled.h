#pragma once
// Newton's method on the forces themselves, for effects whose forces are not the gradient of what linearising freezes: the samples of
// mortar contact turn and slide with the surfaces, friction hangs on the contact forces of the state it acts on. Newton on the frozen
// energies then converges slowly (the Jacobian lacks those terms), or runs in a circle. Here
//
//   r(q) = P grad Phi(q), everything frozen afresh at q
//   J d  = -r   J = H + U, with what moves (potential.h), by GMRES, preconditioned by M, the frozen Hessian without negative curvature
//   q   <- q + alpha d,   alpha halved until |M^-1 r| falls by a quarter of alpha ("natural monotonicity": Deuflhard, Newton Methods
//                         for Nonlinear Problems, 2004, ch. 3.3), and cut short of contact and inversion like every step.
//
// J contains what is missing from M, unsymmetric terms too, so convergence is that of Newton's method.
#include <functional>

#include "solver/arcs.h"
#include "solver/curvature_policy.h"
#include "solver/linear.h"
#include "solver/system.h"

namespace mortise::solver {

class Coupled {
 public:
  Coupled(System& system, Linear& linear, CurvaturePolicy& curvature, linalg::BlockMatrix& A)
      : system_(system), linear_(linear), curvature_(curvature), A_(A), arcs_(system) {}

  // Told of every iterate's residual, and of the step from it, in the environments of `whose`.
  struct Watch {
    std::function<void(const Residual& r, Index iteration, const EnvMask& whose)> begin;
    std::function<void(const EnvMask& whose, const std::vector<Index>& products)> end;
  };

  // From q in the stuck environments, with `at` and `near` for two states. Those whose residual with everything fresh comes down to `relative` are
  // solved then; the others stay stuck at the best state that was found, or fail where forces are not finite. `at` is left at q. `stop` is asked
  // before every iteration and every product, and may throw.
  void solve(device::Buffer<Vec3>& q, double relative, Linearised& at, Linearised& near, EnvTable& envs, const StepReports& report,
             const std::function<void()>& stop, const Watch& watch);

 private:
  void factor(const device::Buffer<Vec3>& q, const EnvMask& whose, Linearised& at);
  void direction(const device::Buffer<Vec3>& q, Linearised& at, const StepReports& report, const std::function<void()>& stop);
  std::vector<double> natural_level(const Linearised& at);
  EnvMask finite_energies(const Linearised& at);
  void monotone_step(device::Buffer<Vec3>& q, Residual& r, Linearised& at, Linearised& near, EnvTable& envs, const StepReports& report);

  System& system_;
  Linear& linear_;
  CurvaturePolicy& curvature_;
  linalg::BlockMatrix& A_;
  Arcs arcs_;

  EnvMask active_, factored_;    // per environment: still iterating; with an M that serves
  std::vector<Index> products_;  // per environment: of the last system
  device::Buffer<Vec3> r0_, x_, dq_, still_, trial_;
};

}  // namespace mortise::solver
