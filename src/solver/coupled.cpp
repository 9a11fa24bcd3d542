// Newton's method on the forces themselves, for effects whose forces are not the gradient of what assembly freezes: the samples of
// mortar contact turn and slide with the surfaces, friction hangs on the contact forces of the state it acts on. Newton on the frozen
// energies then converges slowly (the Jacobian lacks those terms), or runs in a circle. Here
//
//   r(q) = P grad Phi(q), everything frozen afresh at q
//   J v  ~ (r(q + h v) - r(q)) / h,   h max|v_b| = a tenth of the last step, between 1e-12 and 1e-9 of the scene's length
//   J d  = -r   by GMRES, preconditioned by M, the frozen Hessian (Knoll, Keyes, J. Comput. Phys. 193, 2004)
//   q   <- q + alpha d,   alpha halved until |M^-1 r| falls by a quarter of alpha ("natural monotonicity": Deuflhard, Newton Methods
//                         for Nonlinear Problems, 2004, ch. 3.3), and cut short of contact and inversion like every step.
//
// J contains what is missing from M, unsymmetric terms too, so convergence is that of Newton's method.
#include <algorithm>
#include <cmath>

#include "linalg/gmres.h"
#include "solver/kernels.h"
#include "solver/newton.h"
#include "solver/timed.h"

namespace mortise::solver {

// Residual and gradient at `at`; throws Failure where they are not finite.
Residual Newton::fresh_residual(device::Buffer<Vec3>& at) {
  struct Exchange {
    device::Buffer<Vec3>&a, &b;
    Exchange(device::Buffer<Vec3>& x, device::Buffer<Vec3>& y) : a(x), b(y) { a.swap(b); }
    ~Exchange() { a.swap(b); }
  } exchange(q_, at);
  if (options_.lags) refresh_lagged(q_.view());
  return assemble(false);
}

// A motion given on rows as one of all blocks; supports stand still.
void Newton::to_blocks(device::View<const Vec3> rows, device::Buffer<Vec3>& out) {
  device::Buffer<Vec3> still(model_.blocks);
  still.zero();
  step_of(rows, still.view(), row_of_block_.view(), model_.projector.view(), out);
}

void Newton::precondition(device::View<const Vec3> in, device::View<Vec3> out) {
  if (linear_ != Linear::cg) {
    direct_.solve(in, out);
    return;
  }
  constexpr double kRough = 1e-2;
  device::clear(out.p, out.n * sizeof(Vec3));
  run_cg(in, out, std::vector<double>(model_.envs, kRough), std::vector<double>(model_.envs, 0.0));
}

// J v by a difference of residuals; r0 = -P grad Phi at q_.
void Newton::jacobian_product(const device::Buffer<Vec3>& r0, device::View<const Vec3> v, device::View<Vec3> out) {
  device::Buffer<Vec3> move, near;
  to_blocks(v, move);
  std::vector<double> h = largest(move.view(), model_.env_blocks), inverse(model_.envs, 0.0);
  const double wanted = std::clamp(0.1 * last_step_, 1e-12 * length_, 1e-9 * length_);
  for (Index e = 0; e < model_.envs; ++e) {
    h[e] = h[e] > 0 ? wanted / h[e] : 0;
    inverse[e] = h[e] > 0 ? 1 / h[e] : 0;
  }
  near.copy_from(q_);
  add_scaled(move.view(), h, std::as_const(model_.block_env).view(), near);
  fresh_residual(near);
  device::Buffer<Vec3> r1;
  right_hand_side(gradient_.view(), {}, block_of_row_.view(), row_projector_.view(), r1);
  difference(r0.view(), std::as_const(r1).view(), inverse, block_of_row_.view(), std::as_const(model_.block_env).view(), out);
}

// |M^-1 r| of every environment at the state of gradient_.
std::vector<double> Newton::natural_level() {
  device::Buffer<Vec3> r, z(rows_);
  right_hand_side(gradient_.view(), {}, block_of_row_.view(), row_projector_.view(), r);
  precondition(std::as_const(r).view(), z.view());
  return dot(std::as_const(z).view(), std::as_const(z).view(), env_rows_);
}

// Takes a step along dq_ that lowers the level of every environment that has not converged, and the residual r with it; false if
// there is none.
bool Newton::monotone_step(StepReport& report, Residual& r, double relative) {
  constexpr int kMost = 10;
  std::vector<double> alpha(model_.envs, 1.0);
  device::Fetch fetch;
  for (const auto& effect : effects_) effect->max_step(q_.view(), dq_.view(), {alpha, fetch});
  fetch.now();
  for (Index e = 0; e < model_.envs; ++e)
    if (model_.envs > 1 && convergence_.solved(r, e, relative)) alpha[e] = 0;
  const std::vector<double> before = natural_level();
  Residual next;
  for (int k = 0; k < kMost; ++k) {
    advance(q_.view(), dq_.view(), alpha, model_, trial_);
    const std::vector<double> phi = energy(trial_.view());
    std::vector<double> after(model_.envs, INFINITY);
    if (std::all_of(phi.begin(), phi.end(), [](double e) { return std::isfinite(e); })) try {
        next = fresh_residual(trial_);
        after = natural_level();
      } catch (const Failure&) {
      }
    bool ok = true;
    for (Index e = 0; e < model_.envs; ++e) {
      const double share = 1 - 0.25 * alpha[e];
      if (alpha[e] == 0 || after[e] <= share * share * before[e]) continue;
      alpha[e] *= 0.5;
      ok = false;
    }
    if (ok) {
      last_alpha_ = 1;
      for (double a : alpha)
        if (a > 0) last_alpha_ = std::min(last_alpha_, a);
      report.alpha = std::min(report.alpha, last_alpha_);
      q_.swap(trial_);
      r = std::move(next);
      return true;
    }
    ++report.line_search;
  }
  return false;
}

// True when the residual with everything fresh is at most `relative`; otherwise q_ is the best state that was found.
bool Newton::solve_coupled(const effects::StepInfo& info, StepReport& report, double relative, const std::function<void()>& stop) {
  constexpr double kForcing = 1e-4;  // what a difference of forces is good for; the last iteration then ends well below the tolerance
  constexpr Index kMostIterations = 20, kMostProducts = 30, kGood = 12;
  bool factored = factor_fresh_ && linear_ != Linear::cg;
  concave_ = 0;
  Residual r = fresh_residual(q_);
  for (Index it = 0; it < kMostIterations; ++it) {
    stop();
    note(r, relative, report);
    if (options_.trace) trace(info, r, it, report);
    if (converged(r, relative)) return true;
    if (!factored) {
      assemble(true);
      device::Fetch fetch;
      build_matrix(fetch);
      fetch.now();
      if (linear_ == Linear::cg)
        build_preconditioner();
      else if (!direct_.factor(matrix_))
        return false;
      factored = true;
    }
    const Timed timed(clock_, "solver", "coupled");
    device::Buffer<Vec3> r0;
    right_hand_side(gradient_.view(), {}, block_of_row_.view(), row_projector_.view(), r0);
    x_.resize(rows_);
    linalg::GmresResult gmres;
    try {
      gmres = linalg::gmres([&](device::View<const Vec3> in, device::View<Vec3> out) { jacobian_product(r0, in, out); },
                            [&](device::View<const Vec3> in, device::View<Vec3> out) { precondition(in, out); }, std::as_const(r0).view(), x_.view(),
                            env_rows_, kForcing, kMostProducts);
    } catch (const Failure&) {  // a difference went through a surface
      return false;
    }
    report.cg += gmres.iterations;
    fresh_residual(q_);  // products have left the effects elsewhere
    to_blocks(x_.view(), dq_);
    device::Fetch fetch;
    convergence_.see_step(dq_.view(), r, fetch);
    fetch.now();
    last_step_ = largest_of(largest(dq_.view(), model_.env_blocks));
    const std::vector<double> before = forces(r);
    if (!std::isfinite(last_step_) || !monotone_step(report, r, relative)) return false;
    last_force_ = before;
    ++report.newton;
    if (options_.trace) report.trace.back().step = last_step_, report.trace.back().alpha = last_alpha_, report.trace.back().concave = -gmres.iterations;
    factored = gmres.iterations <= kGood && last_alpha_ == 1;
  }
  return false;
}

}  // namespace mortise::solver
