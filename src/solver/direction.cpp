// The Newton direction: matrix, linear solver, and how much negative curvature the matrix may keep.
#include <cmath>

#include "linalg/stale_factor.h"
#include "linalg/supports.h"
#include "solver/kernels.h"
#include "solver/newton.h"
#include "solver/timed.h"

namespace mortise::solver {
namespace {

constexpr double kLeastConcave = 0.05;  // less than this makes no difference to convergence
constexpr double kLoose = 1e-9;         // of the mean stiffness: far above rounding, far below the softest elastic motion

}  // namespace

// A cut step shows that the quadratic model reaches too far: convex pieces are safer then. After a full one the exact Hessian is
// tried again, as it converges quadratically. Environments must not see each other's choices, so several of them stay convex.
void Newton::choose_curvature() {
  if (model_.envs > 1 || last_alpha_ < 1)
    concave_ = 0;
  else
    concave_ = concave_ == 0 ? 1 : std::min(1.0, 2 * concave_);
}

void Newton::soften() {
  concave_ *= 0.25;
  if (concave_ < kLeastConcave) concave_ = 0;
}

void Newton::build_matrix(device::Fetch& fetch) {
  const Timed timed(clock_, "solver", "matrix");
  assembler_.matrix(sets_, matrix_);
  convergence_.see_matrix(matrix_, q_.view(), block_of_row_.view(), fetch);
  if (any_partial_) linalg::project(matrix_, row_projector_.view());
  // Without a shift rounding decides how far a body that nothing holds goes along its free motions.
  if (any_loose_) shift_diagonal(matrix_, kLoose);
}

// A fresh factor, or conjugate gradients with the last one as long as that is cheaper. A factor never outlives the step, so
// that a restart between steps meets the same factors.
bool Newton::solve_direct(StepReport& report) {
  constexpr double kForcing = 1e-2;  // inexact Newton: the residual still falls a hundredfold per iteration
  constexpr Index kMost = 16;        // a factor costs about as much as this many solves with it
  if (linear_ == Linear::reuse && factor_fresh_) {
    const linalg::StaleResult cg = linalg::solve_with_stale_factor(matrix_, direct_, rhs_.view(), x_.view(), kForcing, kMost);
    report.cg += cg.iterations;
    if (cg.converged) {
      factor_fresh_ = cg.iterations <= kMost / 2;
      return true;
    }
  }
  // A small shift picks the shortest step among motions that nothing resists.
  double shift = 1e-10;
  factor_fresh_ = false;
  while (!direct_.factor(matrix_)) {
    if (concave_ > 0) return false;
    if (shift > 1e-2) throw Failure{"the matrix is not positive definite"};
    shift_diagonal(matrix_, shift);
    shift *= 100;
    ++report.regularised;
  }
  direct_.solve(rhs_.view(), x_.view());
  factor_fresh_ = true;
  return true;
}

// (P H P + I - P) x = -P (g + H c) on the rows; false if the matrix is not positive definite and can be made so.
bool Newton::solve_linear(StepReport& report, bool supports_move) {
  device::Fetch fetch;
  build_matrix(fetch);
  device::Buffer<Vec3> Hc;
  if (supports_move) {
    for (linalg::StencilSet* set : sets_) stencil_product(*set, support_.view());
    assembler_.gradient(sets_, model_.blocks, Hc);
  }
  right_hand_side(gradient_.view(), std::as_const(Hc).view(), block_of_row_.view(), row_projector_.view(), rhs_);
  rhs2_.assign(model_.envs, 0.0);
  dot(std::as_const(rhs_).view(), std::as_const(rhs_).view(), env_rows_, {rhs2_, fetch});
  fetch.now();
  x_.resize(rows_);
  x_.zero();
  if (rows_ == 0) return true;
  const Timed timed(clock_, "solver", "linear_solve");
  return linear_ == Linear::cg ? solve_cg(report) : solve_direct(report);
}

void Newton::direction(StepReport& report, const Residual& r, double relative, bool supports_move) {
  wanted_.resize(model_.envs);
  for (Index e = 0; e < model_.envs; ++e) wanted_[e] = convergence_.least_tolerance(r, e, relative);
  while (!solve_linear(report, supports_move)) {
    soften();
    ++report.softened;
    assemble(true);
  }
  step_of(x_.view(), support_.view(), row_of_block_.view(), model_.projector.view(), dq_);
  std::vector<double> longest(model_.envs, 0.0);
  slope_.assign(model_.envs, 0.0);
  device::Fetch fetch;
  largest(dq_.view(), model_.env_blocks, {longest, fetch});
  convergence_.see_step(dq_.view(), r, fetch);
  dot(gradient_.view(), dq_.view(), model_.env_blocks, {slope_, fetch});
  fetch.now();
  last_step_ = largest_of(longest);
  if (!std::isfinite(last_step_)) throw Failure{"the Newton direction is not finite"};
}

}  // namespace mortise::solver
