#include "solver/newton.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <sstream>

#include "solver/kernels.h"
#include "solver/timed.h"

namespace mortise::solver {
namespace {

// Diagonal of the scene at rest [m], the length against which support gaps are judged.
double scene_length(const model::Model& model) {
  Vec3 lo = Vec3::Constant(INFINITY), hi = -lo;
  for (const Vec3& x : model.rest_points.download()) lo = lo.cwiseMin(x), hi = hi.cwiseMax(x);
  return (hi - lo).norm();
}

}  // namespace

Newton::Newton(model::Model& model, EffectList& effects, const Options& options, Clock& clock)
    : model_(model), effects_(effects), options_(options), clock_(clock), convergence_(model, options), length_(scene_length(model)), effect_gradients_(effects.size()) {
  choose_linear();
  for (const auto& effect : effects_) conservative_ = conservative_ && effect->conservative();
}

// A factor of a small matrix costs next to nothing; of a larger one it is worth keeping for some iterations; and beyond some
// size its memory and work grow faster than the iterations of conjugate gradients do (README, "What it costs").
void Newton::choose_linear() {
  constexpr Index kDirectBlocks = 2000, kReuseBlocks = 20000;
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
  any_loose_ = options_.is_static && std::any_of(model_.bodies.begin(), model_.bodies.end(), [this](const model::Body& body) {
    return std::all_of(held_.begin() + body.block_begin, held_.begin() + body.block_end, [](auto held) { return held == 0; });
  });
  row_of_block_.upload(row_of_block);
  block_of_row_.upload(block_of_row);
  row_projector_.upload(row_projector);
  convergence_.set_rows(row_of_block);
  assembler_.set_rows(device::Buffer<Index>(row_of_block), rows_);
  cg_.reset();
}

Residual Newton::assemble(bool hessian) {
  Residual r = convergence_.begin();
  device::Fetch fetch;
  gradient_.resize(model_.blocks);
  gradient_.zero();
  sets_.clear();
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    effects::Effect& effect = *effects_[k];
    const Timed timed(clock_, effect.name(), hessian ? "assemble" : "gradient");
    linalg::StencilSet& set = effect.assemble(q_.view(), effects::Curvature(hessian, concave_));
    sets_.push_back(&set);
    linalg::StencilSet* const one[] = {&set};
    assembler_.gradient(one, model_.blocks, effect_gradients_[k]);
    convergence_.see_effect(effect, effect_gradients_[k].view(), r, fetch);
    add(effect_gradients_[k].view(), gradient_);
  }
  convergence_.see_sum(gradient_.view(), q_.view(), r, fetch);
  support_move(q_.view(), model_.target.view(), model_.projector.view(), support_);
  largest(support_.view(), model_.env_blocks, {r.support_gap, fetch});
  fetch.now();
  convergence_.finish(r);
  for (double f : r.force)
    if (!std::isfinite(f)) throw Failure{not_finite()};
  return r;
}

std::string Newton::not_finite() const {
  for (std::size_t k = 0; k < effects_.size(); ++k)
    for (double f : largest(effect_gradients_[k].view(), model_.env_blocks))
      if (!std::isfinite(f)) return "the force of '" + std::string(effects_[k]->name()) + "' is not finite at " + name_block(model_, worst_block(model_, effect_gradients_[k]));
  return "the force residual is not finite";
}

std::vector<double> Newton::forces(const Residual& r) const {
  std::vector<double> force;
  for (Index e = 0; e < model_.envs; ++e) force.push_back(convergence_.largest_force(r, e));
  return force;
}

bool Newton::converged(const Residual& r, double relative) const {
  for (Index e = 0; e < model_.envs; ++e)
    if (!convergence_.solved(r, e, relative) || r.support_gap[e] > 1e-13 * length_) return false;
  return options_.step_tolerance <= 0 || last_step_ <= options_.step_tolerance;
}

void Newton::note(const Residual& r, double relative, StepReport& report) const {
  const Convergence::Worst worst = convergence_.worst(r, relative);
  report.residual = worst.force, report.tolerance = worst.tolerance, report.residual_share = convergence_.share(r);
}

void Newton::find_energies(device::View<const Vec3> q, Energies& of, device::Fetch& fetch) {
  of.resize(effects_.size());
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    if (!of[k].empty()) continue;
    const Timed timed(clock_, effects_[k]->name(), "energy");
    of[k].assign(model_.envs, 0.0);
    effects_[k]->energy(q, {of[k], fetch});
  }
}

std::vector<double> Newton::sum(const Energies& energies) {
  std::vector<double> total(model_.envs, 0.0);
  energy_scale_.assign(model_.envs, 0.0);
  for (const std::vector<double>& part : energies)
    for (Index e = 0; e < model_.envs; ++e) {
      total[e] += part[e];
      energy_scale_[e] += std::abs(part[e]);
    }
  return total;
}

std::vector<double> Newton::energy(device::View<const Vec3> q, Energies& of) {
  device::Fetch fetch;
  find_energies(q, of, fetch);
  fetch.now();
  return sum(of);
}

std::vector<double> Newton::energy(device::View<const Vec3> q) {
  Energies unknown;
  return energy(q, unknown);
}

// Of effects that freeze something at assembly, energies are a matter of one iteration.
void Newton::remember(Energies&& at_q) {
  known_ = std::move(at_q);
  for (std::size_t k = 0; k < known_.size(); ++k)
    if (!effects_[k]->conservative()) known_[k].clear();
}

// By what contact effects published last.
void Newton::find_groups() {
  std::vector<const model::ContactView*> contacts;
  for (const auto& effect : effects_)
    if (const model::ContactView* view = model_.contact(std::string(effect->name()))) contacts.push_back(view);
  convergence_.connect(contacts);
}

// Newton's method gains digits faster and faster near a solution; what does not is a sign that the matrix lacks something: iterations
// creep, or gain the same one or two digits each while more than one of them is still missing.
bool Newton::needs_jacobian(const Residual& r, Index iteration, double relative) {
  constexpr double kFast = 0.1, kQuadratic = 1e-3;
  constexpr Index kPatience = 3, kUsual = 20;  // the way into contact takes some iterations, at full steps too
  if (model_.envs > 1) return iteration == options_.iterations;  // environments must not have a say in how others are solved
  if (iteration == 0) {
    slow_ = 0;
    return false;
  }
  const double share = convergence_.largest_force(r, 0) / last_force_[0];
  slow_ = share > kFast ? slow_ + 1 : 0;
  const bool creeps = slow_ >= kPatience && iteration >= kUsual;
  const bool linear = share < kFast && share > kQuadratic && last_alpha_ == 1 && convergence_.over(r, 0, relative) * share > 1;
  factor_fresh_ &= !creeps;
  return creeps || (linear && factor_fresh_ && !lags_);
}

// Where the residual was least: what coupled.cpp starts from, since it converges only from nearby and iterations that run in a circle may end
// anywhere on it.
void Newton::remember_nearest(const Residual& r) {
  const double force = largest_of(r.force);
  if (force >= nearest_force_) return;
  nearest_force_ = force;
  nearest_q_.copy_from(q_);
}

// False when it gave up because coupled.cpp may do better.
bool Newton::iterate(const effects::StepInfo& info, StepReport& report, double relative, const std::function<void()>& stop) {
  constexpr Index kFirstLook = 8;  // at what touches by now; then ever more seldom
  last_force_.assign(model_.envs, 0.0);
  nearest_force_ = INFINITY;
  for (Index it = 0;; ++it) {
    stop();
    if (!lags_ && it >= kFirstLook && std::has_single_bit(static_cast<unsigned>(it))) {
      refresh_lagged(q_.view());
      find_groups();
    }
    choose_curvature();
    const Residual r = assemble(true);
    note(r, relative, report);
    if (options_.trace) trace(info, r, it, report);
    if (converged(r, relative)) return true;
    if (may_couple_ && largest_of(r.support_gap) == 0) {
      remember_nearest(r);
      if (needs_jacobian(r, it, relative)) {
        q_.copy_from(nearest_q_);
        return false;
      }
    }
    if (it == options_.iterations) {
      std::ostringstream why;
      why << "Newton stopped after " << it << " iterations with a force residual of " << report.residual << " N on '" << model_.bodies[convergence_.worst(r, relative).body].name << "' (wanted " << report.tolerance << " N)";
      if (largest_of(r.support_gap) > 0) why << "; supports are " << largest_of(r.support_gap) << " m from their targets";
      throw Failure{why.str()};
    }
    const bool supports_move = largest_of(r.support_gap) > 0;
    direction(report, r, relative, supports_move);
    last_alpha_ = line_search(report, r, relative, supports_move);
    last_force_ = forces(r);
    ++report.newton;
    if (options_.trace) report.trace.back().step = last_step_, report.trace.back().alpha = last_alpha_, report.trace.back().concave = concave_;
  }
}

void Newton::trace(const effects::StepInfo& info, const Residual& r, Index iteration, StepReport& report) {
  const std::vector<double> phi = energy(q_.view());
  Iterate now;
  now.time = info.t1(), now.dt = info.dt, now.round = report.lag, now.iteration = iteration;
  now.residual = largest_of(r.force), now.tolerance = report.tolerance;
  for (double e : phi) now.energy += e;
  now.where = name_block(model_, worst_block(model_, gradient_));
  report.trace.push_back(now);
}

void Newton::solve(const effects::StepInfo& info, StepReport& report, const std::function<void()>& stop, bool again) {
  number_rows();
  if (!again) q_.copy_from(model_.q);
  convergence_.begin_step();
  find_groups();
  factor_fresh_ = false;
  cg_last_rhs_.clear();
  built_speed_ = 0;
  concave_ = last_alpha_ = 0;
  known_.clear();
  start_.clear();
  lags_ = options_.lags;
  lag_q_.copy_from(q_);
  lag_share_.assign(model_.envs, 1.0);
  constexpr Index kPlainRounds = 2;
  const double settled = std::max(options_.lag_tolerance, options_.relative_tolerance);
  double relative = lags_ ? 10 * settled : options_.relative_tolerance;
  may_couple_ = !conservative_;
  for (Index round = 0;; ++round) {
    last_step_ = 0;
    if (!iterate(info, report, relative, stop) || (may_couple_ && round >= kPlainRounds)) {
      if (solve_coupled(info, report, lags_ ? settled : options_.relative_tolerance, stop)) {
        if (lags_) report.lag_residual = report.residual, report.lag_share = report.residual_share;
        known_.clear();
        break;
      }
      may_couple_ = false;
      known_.clear();
      refresh_lagged(q_.view());
      lag_q_.copy_from(q_);
      iterate(info, report, relative, stop);
    }
    if (!lags_) break;
    if (!refresh_lagged(q_.view())) {
      lags_ = false;  // nothing to refresh in this step after all: solve to the end
      relative = options_.relative_tolerance;
      continue;
    }
    ++report.lag;
    find_groups();
    const Residual fresh = assemble(false);
    last_force_.assign(model_.envs, 0.0);
    convergence_.refreshed();
    report.lag_residual = largest_of(fresh.force), report.lag_share = convergence_.share(fresh);
    if (converged(fresh, settled)) break;
    if (round == options_.lag_iterations) {
      std::ostringstream why;
      why << "lagged quantities (friction) did not settle in " << round << " rounds: residual " << report.lag_residual << " N";
      throw Failure{why.str()};
    }
    // There is no point in solving far beyond what refreshing changes.
    relative = std::clamp(0.1 * report.lag_share, 0.1 * settled, 10 * settled);
    relax_lagged(round);
  }
  device::Fetch fetch;
  find_energies(q_.view(), known_, fetch);
  measure_gain(known_, fetch);
  const std::vector<double> phi = sum(known_);
  report.energy = 0;
  for (double e : phi) report.energy += e;
}

}  // namespace mortise::solver
