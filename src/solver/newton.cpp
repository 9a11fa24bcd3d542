#include "solver/newton.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>

#include "linalg/cg.h"
#include "linalg/stale_factor.h"
#include "linalg/supports.h"
#include "solver/kernels.h"
#include "solver/timed.h"

namespace mortise::solver {
namespace {

double largest_of(const std::vector<double>& v) { return v.empty() ? 0 : *std::max_element(v.begin(), v.end()); }

// Diagonal of the scene at rest [m], the length against which support gaps are judged.
double scene_length(const model::Model& model) {
  Vec3 lo = Vec3::Constant(INFINITY), hi = -lo;
  for (const Vec3& x : model.rest_points.download()) lo = lo.cwiseMin(x), hi = hi.cwiseMax(x);
  return (hi - lo).norm();
}

}  // namespace

Newton::Newton(model::Model& model, EffectList& effects, const Options& options, Clock& clock)
    : model_(model), effects_(effects), options_(options), clock_(clock), length_(scene_length(model)), effect_gradients_(effects.size()) {
  choose_linear();
}

// A factor of a small matrix costs next to nothing; of a larger one it is worth keeping for some iterations; and beyond some
// size its memory and work grow faster than the iterations of conjugate gradients do (README, "What it costs").
void Newton::choose_linear() {
  constexpr Index kDirectBlocks = 2000, kReuseBlocks = 60000;
  const std::string size = std::to_string(model_.blocks) + " blocks";
  if (options_.linear != "auto") {
    linear_ = options_.linear == "cg" ? Linear::cg : options_.linear == "reuse" ? Linear::reuse : Linear::direct;
    linear_reason_ = "asked for by the scene";
  } else if (model_.blocks <= kDirectBlocks) {
    linear_ = Linear::direct, linear_reason_ = size + ", a new factor each time up to " + std::to_string(kDirectBlocks);
  } else if (model_.blocks <= kReuseBlocks) {
    linear_ = Linear::reuse, linear_reason_ = size + ", factors up to " + std::to_string(kReuseBlocks);
  } else {
    linear_ = Linear::cg, linear_reason_ = size + ", more than " + std::to_string(kReuseBlocks);
  }
}

void Newton::number_rows() {
  if (model_.held == held_ && rows_ > 0) return;
  held_ = model_.held;
  const std::vector<Mat3> projector = model_.projector.download();
  std::vector<Index> row_of_block(held_.size(), -1), block_of_row;
  std::vector<Mat3> row_projector;
  env_rows_.assign(1, 0);
  any_partial_ = false;
  for (Index e = 0; e < model_.envs; ++e) {
    for (Index b = model_.env_blocks[e]; b < model_.env_blocks[e + 1]; ++b) {
      if (held_[b] == 2) continue;
      any_partial_ |= held_[b] == 1;
      row_of_block[b] = static_cast<Index>(block_of_row.size());
      block_of_row.push_back(b);
      row_projector.push_back(projector[b]);
    }
    env_rows_.push_back(static_cast<Index>(block_of_row.size()));
  }
  rows_ = static_cast<Index>(block_of_row.size());
  row_of_block_.upload(row_of_block);
  block_of_row_.upload(block_of_row);
  row_projector_.upload(row_projector);
  assembler_.set_rows(device::Buffer<Index>(row_of_block), rows_);
}

Newton::Residual Newton::assemble(bool hessian) {
  Residual r;
  r.scale.assign(model_.envs, 0.0);
  gradient_.resize(model_.blocks);
  gradient_.zero();
  sets_.clear();
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    effects::Effect& effect = *effects_[k];
    const Timed timed(clock_, effect.name(), hessian ? "assemble" : "gradient");
    linalg::StencilSet& set = effect.assemble(q_.view(), hessian);
    sets_.push_back(&set);
    linalg::StencilSet* const one[] = {&set};
    assembler_.gradient(one, model_.blocks, effect_gradients_[k]);
    const std::vector<double> here = largest(effect_gradients_[k].view(), model_.env_blocks);
    for (Index e = 0; e < model_.envs; ++e) r.scale[e] = std::max(r.scale[e], here[e]);
    add(effect_gradients_[k].view(), gradient_);
  }
  r.force = largest(gradient_.view(), model_.projector.view(), model_.env_blocks);
  support_move(q_.view(), model_.target.view(), model_.projector.view(), support_);
  r.support_gap = largest(support_.view(), model_.env_blocks);
  for (double f : r.force)
    if (!std::isfinite(f)) throw Failure{"the force residual is not finite"};
  return r;
}

double Newton::tolerance(const Residual& r, Index e, double relative) const {
  return std::max({options_.force_tolerance, relative * r.scale[e], rounding_[e]});
}

bool Newton::converged(const Residual& r, double relative) const {
  for (Index e = 0; e < model_.envs; ++e)
    if (r.force[e] > tolerance(r, e, relative) || r.support_gap[e] > 1e-13 * length_) return false;
  return options_.step_tolerance <= 0 || last_step_ <= options_.step_tolerance;
}

// A fresh factor, or conjugate gradients with the last one as long as that is cheaper. A factor never outlives the step, so
// that a restart between steps meets the same factors.
void Newton::solve_direct(StepReport& report) {
  constexpr double kForcing = 1e-2;  // inexact Newton: the residual still falls a hundredfold per iteration
  constexpr Index kMost = 16;        // a factor costs about as much as this many solves with it
  if (linear_ == Linear::reuse && factor_fresh_) {
    const linalg::StaleResult cg = linalg::solve_with_stale_factor(matrix_, direct_, rhs_.view(), x_.view(), kForcing, kMost);
    report.cg += cg.iterations;
    if (cg.converged) {
      factor_fresh_ = cg.iterations <= kMost / 2;
      return;
    }
  }
  // A static scene may be held by contact alone: a small shift then picks the shortest step among the free motions.
  double shift = 1e-10;
  while (!direct_.factor(matrix_)) {
    if (shift > 1e-2) throw Failure{"the matrix is not positive definite"};
    shift_diagonal(matrix_, shift);
    shift *= 100;
    ++report.regularised;
  }
  direct_.solve(rhs_.view(), x_.view());
  factor_fresh_ = true;
}

void Newton::direction(StepReport& report, bool supports_move) {
  device::Buffer<Vec3> Hc;
  {
    const Timed timed(clock_, "solver", "matrix");
    assembler_.matrix(sets_, matrix_);
    rounding_ = rounding_floor(matrix_, q_.view(), block_of_row_.view(), env_rows_);
    if (any_partial_) linalg::project(matrix_, row_projector_.view());
  }
  if (supports_move) {
    for (linalg::StencilSet* set : sets_) stencil_product(*set, support_.view());
    assembler_.gradient(sets_, model_.blocks, Hc);
  }
  right_hand_side(gradient_.view(), std::as_const(Hc).view(), block_of_row_.view(), row_projector_.view(), rhs_);
  x_.resize(rows_);
  x_.zero();
  if (rows_ > 0) {
    const Timed timed(clock_, "solver", "linear_solve");
    if (linear_ == Linear::cg) {
      const std::vector<double> relative(model_.envs, options_.cg_tolerance);
      const linalg::CgResult cg = linalg::conjugate_gradients(matrix_, rhs_.view(), x_.view(), env_rows_, relative, {options_.cg_iterations, 0});
      report.cg += cg.iterations();
      for (const linalg::CgResult::Env& env : cg.env)
        if (env.end == linalg::CgEnd::iteration_limit || (env.end == linalg::CgEnd::not_positive_definite && env.iterations == 0)) {
          std::ostringstream why;
          why << "conjugate gradients stopped after " << env.iterations << " iterations at " << env.residual / env.rhs << " of the right-hand side (wanted " << options_.cg_tolerance << ")";
          throw Failure{why.str()};
        }
    } else {
      solve_direct(report);
    }
  }
  step_of(x_.view(), support_.view(), row_of_block_.view(), model_.projector.view(), dq_);
  last_step_ = largest_of(largest(dq_.view(), model_.env_blocks));
  if (!std::isfinite(last_step_)) throw Failure{"the Newton direction is not finite"};
}

std::vector<double> Newton::energy(device::View<const Vec3> q) {
  std::vector<double> total(model_.envs, 0.0);
  energy_scale_.assign(model_.envs, 0.0);
  for (const auto& effect : effects_) {
    const Timed timed(clock_, effect->name(), "energy");
    std::vector<double> part(model_.envs, 0.0);
    effect->energy(q, part);
    for (Index e = 0; e < model_.envs; ++e) {
      total[e] += part[e];
      energy_scale_[e] += std::abs(part[e]);
    }
  }
  return total;
}

void Newton::line_search(StepReport& report, const Residual& r, double relative, bool supports_move) {
  constexpr double kArmijo = 1e-4;
  constexpr int kMost = 40;
  std::vector<double> alpha(model_.envs, 1.0);
  for (const auto& effect : effects_) {
    const Timed timed(clock_, effect->name(), "max_step");
    effect->max_step(q_.view(), dq_.view(), alpha);
  }
  const std::vector<double> before = energy(q_.view());
  std::vector<double> slope = dot(gradient_.view(), dq_.view(), model_.env_blocks);
  std::vector<double> rho(model_.envs, 0.0), cc(model_.envs, 0.0);
  if (supports_move) {
    // rho makes the quadratic model of the merit decrease over the full step and its slope negative.
    device::Buffer<Vec3> Hdq;
    for (linalg::StencilSet* set : sets_) stencil_product(*set, dq_.view());
    assembler_.gradient(sets_, model_.blocks, Hdq);
    const std::vector<double> curvature = dot(dq_.view(), Hdq.view(), model_.env_blocks);
    cc = dot(support_.view(), support_.view(), model_.env_blocks);
    for (Index e = 0; e < model_.envs; ++e) {
      if (!(cc[e] > 0)) continue;
      rho[e] = std::max(0.0, 2 * (2 * slope[e] + curvature[e]) / cc[e]);
      slope[e] -= rho[e] * cc[e];
    }
  }
  for (Index e = 0; e < model_.envs; ++e)
    if (model_.envs > 1 && r.force[e] <= tolerance(r, e, relative) && r.support_gap[e] == 0) alpha[e] = 0;

  for (int k = 0;; ++k) {
    advance(q_.view(), dq_.view(), alpha, model_, trial_);
    const std::vector<double> after = energy(trial_.view());
    bool ok = true;
    for (Index e = 0; e < model_.envs; ++e) {
      if (alpha[e] == 0) continue;
      const double left = (1 - alpha[e]) * (1 - alpha[e]);
      const double change = after[e] - before[e] + 0.5 * rho[e] * (left - 1) * cc[e];
      const double rounding = 1e-13 * energy_scale_[e];
      if (std::isfinite(after[e]) && change <= kArmijo * alpha[e] * slope[e] + rounding) continue;
      // A support that pushes a body into contact that no Hessian knows of yet has no finite rho beforehand: take the one for
      // which the shortened step is good enough, or the support would creep up to the range of the contact for ever.
      if (k >= 2 && cc[e] > 0 && std::isfinite(after[e])) continue;
      alpha[e] *= 0.5;
      ok = false;
    }
    if (ok) break;
    ++report.line_search;
    if (k == kMost) throw Failure{"the line search found no descent"};
  }
  for (double a : alpha)
    if (a > 0) report.alpha = std::min(report.alpha, a);
  q_.swap(trial_);
}

void Newton::iterate(StepReport& report, double relative, const std::function<void()>& stop) {
  for (Index it = 0;; ++it) {
    stop();
    const Residual r = assemble(true);
    report.residual = largest_of(r.force);
    report.tolerance = 0;
    for (Index e = 0; e < model_.envs; ++e) report.tolerance = std::max(report.tolerance, tolerance(r, e, relative));
    if (converged(r, relative)) return;
    if (it == options_.iterations) {
      std::ostringstream why;
      why << "Newton stopped after " << it << " iterations with a force residual of " << report.residual << " N (wanted " << report.tolerance << " N)";
      if (largest_of(r.support_gap) > 0) why << "; supports are " << largest_of(r.support_gap) << " m from their targets";
      throw Failure{why.str()};
    }
    const bool supports_move = largest_of(r.support_gap) > 0;
    direction(report, supports_move);
    line_search(report, r, relative, supports_move);
    ++report.newton;
  }
}

void Newton::solve(StepReport& report, const std::function<void()>& stop) {
  number_rows();
  q_.copy_from(model_.q);
  rounding_.assign(model_.envs, 0.0);
  lags_ = options_.lags;
  factor_fresh_ = false;
  for (Index round = 0;; ++round) {
    last_step_ = 0;
    // With quantities frozen there is no point in solving far beyond what refreshing them will change.
    const double relative = lags_ ? std::max(options_.relative_tolerance, 0.1 * options_.lag_tolerance) : options_.relative_tolerance;
    iterate(report, relative, stop);
    bool lagged = false;
    for (const auto& effect : effects_) {
      const Timed timed(clock_, effect->name(), "lag");
      lagged |= effect->lag(q_.view());
    }
    if (!lagged) {
      if (!lags_) break;
      lags_ = false;  // nothing to refresh in this step after all: solve to the end
      continue;
    }
    ++report.lag;
    const Residual fresh = assemble(false);
    report.lag_residual = largest_of(fresh.force);
    if (converged(fresh, std::max(options_.lag_tolerance, options_.relative_tolerance))) break;
    if (round == options_.lag_iterations) {
      std::ostringstream why;
      why << "lagged quantities (friction) did not settle in " << round << " rounds: residual " << report.lag_residual << " N";
      throw Failure{why.str()};
    }
  }
  const std::vector<double> phi = energy(q_.view());
  report.energy = 0;
  for (double e : phi) report.energy += e;
}

}  // namespace mortise::solver
