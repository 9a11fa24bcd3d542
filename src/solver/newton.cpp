#include "solver/newton.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

#include "solver/kernels.h"
#include "solver/tuning.h"

namespace mortise::solver {
Newton::Newton(model::Model& model, EffectList& effects, const Options& options, Clock& clock)
    : system_(model, effects, options, clock),
      model_(model),
      options_(options),
      envs_(model.envs),
      linear_choice_(choose_linear(model, options)),
      linear_(linear_choice_.kind == "cg" ? make_cg(model, system_.rows, options) : make_direct(model, system_.rows, linear_choice_.kind == "reuse")),
      curvature_(model.envs),
      direction_(system_, *linear_, curvature_),
      moving_(model.envs),
      saddle_(model.envs),
      energies_(model, system_.potential),
      outlook_(system_, *linear_, energies_, saddle_),
      line_search_(system_, energies_),
      first_guess_(system_, energies_),
      lag_(system_, std::max(options.lag_tolerance, options.relative_tolerance), system_.potential.lags()),
      coupled_(system_, *linear_, curvature_, direction_.matrix()),
      trace_(system_, curvature_),
      at_(system_.potential.linearised()),
      beside_(system_.potential.linearised()),
      held_(model.envs, 0) {}

void Newton::begin(const EnvMask& whose) {
  if (q_.size() != model_.blocks) q_.copy_from(model_.q);
  copy_envs(model_.q, whose, model_.env_blocks, q_);
  lag_here(whose);
  fresh_.resize(envs_.size(), 0);
  for (Index e = 0; e < envs_.size(); ++e) fresh_[e] |= whose[e];
}

void Newton::lag_here(const EnvMask& whose) {
  const model::Only only(model_, whose);
  system_.potential.linearise(std::as_const(q_).view(), effects::Want::frozen(), at_);
  system_.potential.sample(at_);
  system_.potential.lag(at_, at_);
  held_ = whose;
}

// An environment comes here with the lagged quantities of its own state.
void Newton::hold(const EnvMask& whose) {
  bool all = true;
  for (Index e = 0; e < envs_.size(); ++e) all = all && (held_[e] || !whose[e]);
  if (all || envs_.size() == 1) return;
  const model::Only only(model_, whose);
  system_.potential.linearise(std::as_const(q_).view(), effects::Want::frozen(), at_, true);
  system_.potential.sample(at_);
  held_ = whose;
}

void Newton::end_at(const device::Buffer<Vec3>& q) {
  const EnvMask all(model_.envs, 1);
  begin(all);
  energies_.begin_solve();
  device::Fetch fetch;
  energies_.find(std::as_const(q_).view(), at_, fetch);
  fetch.now("end of follower");
  energies_.begin_search(all);
  energies_.accept({});
  q_.copy_from(q);
  system_.potential.linearise(std::as_const(q_).view(), {}, at_, true);
  system_.potential.sample(at_);
  energies_.close(std::as_const(q_).view(), at_);
}

void Newton::fail(Index env, const std::string& reason) {
  envs_.fail(env, reason);
  copy_blocks(model_.q, model_.env_blocks[env], model_.env_blocks[env + 1], q_);
}

// Environments that iterate with nothing frozen.
EnvMask Newton::changing() const {
  EnvMask out = envs_.mask(EnvState::running);
  for (Index e = 0; e < envs_.size() && system_.potential.lags(); ++e) out[e] &= static_cast<std::uint8_t>(envs_[e].whole);
  return out;
}

// A single environment has nobody to go on for.
void Newton::check_failed() {
  if (envs_.size() == 1 && envs_.is(0, EnvState::failed)) throw Failure{envs_[0].reason};
  for (Index e = 0; e < envs_.size(); ++e)
    if (envs_.is(e, EnvState::failed)) fail(e, envs_[e].reason);
}

void Newton::solve(const effects::StepInfo& info, const StepReports& report, const std::function<void()>& stop, const EnvMask& whose) {
  const bool whole = system_.potential.lags() && system_.potential.follows_locally(at_);
  for (Index e = 0; e < envs_.size(); ++e) {
    envs_[e] = {};
    envs_[e].state = whose[e] ? EnvState::running : EnvState::solved;
    envs_[e].may_couple = !system_.potential.symmetric();
    envs_[e].whole = whole;
  }
  const EnvMask all = model_.at_work.empty() ? EnvMask(envs_.size(), 1) : model_.at_work;  // that take the step
  hold(whose);
  std::optional<model::Only> only(std::in_place, model_, whose);
  system_.begin_solve();
  system_.find_groups(at_, whose);
  linear_->begin_solve(system_.rows_changed());
  curvature_.begin_step();
  energies_.begin_solve();
  lag_.begin_solve(q_);
  for (Index e = 0; e < envs_.size(); ++e) fresh_[e] &= whose[e];
  stays_ = fresh_ == whose;
  const EnvMask guessed = first_guess_.find(std::exchange(fresh_, EnvMask(envs_.size(), 0)), q_, at_);
  foreseen_ = first_guess_.landed(), stays_ = stays_ && !any(guessed);
  for (Index e = 0; e < envs_.size(); ++e)
    if (guessed[e]) envs_[e].alpha = 1;  // a full step
  for (Index round = 0;; ++round) {
    for (Index e = 0; e < envs_.size(); ++e) envs_[e].step = 0;
    iterate(info, report, stop);
    couple(round, info, report, stop);
    if (!refresh(round, report)) break;
  }
  for (Index e = 0; e < envs_.size(); ++e)
    if (!envs_.is(e, EnvState::solved) && !envs_.is(e, EnvState::failed)) envs_.fail(e, "Newton ended without a solution");
  check_failed();
  only.reset();
  hold(all);
  system_.potential.sample(at_);
  energies_.close(std::as_const(q_).view(), at_);
  for (Index e = 0; e < envs_.size(); ++e)
    if (whose[e]) report[e].energy = energies_.total(e);
}

// Until no environment runs any more: each has settled, is stuck or has failed.
void Newton::iterate(const effects::StepInfo& info, const StepReports& report, const std::function<void()>& stop) {
  for (Index e = 0; e < envs_.size(); ++e)
    if (envs_.is(e, EnvState::running)) envs_[e].force = 0, envs_[e].refused = 0, moving_.begin(e), saddle_.begin(e);
  outlook_.begin();
  for (Index it = 0;; ++it) {
    stop();
    for (Index e = 0; e < envs_.size(); ++e) {
      if (!envs_.is(e, EnvState::running)) continue;
      curvature_.choose(e, envs_[e].alpha);
      // In rounds of lagged quantities the energy that is minimised has no Jacobian but its Hessian.
      const bool fresh = envs_[e].whole || !system_.potential.lags();
      envs_[e].moving = moving_.choose(e, envs_[e].alpha) && fresh && system_.potential.freezes();
    }
    held_ = envs_.mask(EnvState::running);
    const model::Only only(model_, held_);
    effects::Want want = direction_.want(envs_);
    want.foreseen = std::exchange(foreseen_, false), want.here = std::exchange(stays_, false);
    system_.potential.linearise(std::as_const(q_).view(), want, at_, want.whole);
    if ((!system_.potential.lags() || want.whole) && it >= tuning::kFirstLook && std::has_single_bit(static_cast<unsigned>(it)))
      system_.find_groups(at_, changing());
    device::Fetch state;  // what the host hears of the iterate
    direction_.forget();
    if (it != last_) {  // after as many iterations as last time it may be the solution, of which nobody wants a matrix
      system_.begin_matrix(at_, state);
      direction_.foresee(at_, state);
    }
    const Residual r = system_.residual(std::as_const(q_).view(), at_, state);
    for (Index e = 0; e < envs_.size(); ++e)
      if (envs_.is(e, EnvState::running) && !system_.convergence.finite(r, e)) envs_.fail(e, system_.not_finite(at_, e));
    check_failed();
    for (Index e = 0; e < envs_.size(); ++e)
      if (envs_.is(e, EnvState::running) && held_loosely(e) && envs_[e].arrived)
        system_.hold.look(e, {envs_[e].force, envs_[e].sum}, left(r, e), envs_[e].alpha, envs_[e].step);
    for (Index e = 0; e < envs_.size(); ++e)
      if (r.support_gap[e] == 0) system_.hold.let_go(e);
    const EnvMask judged = envs_.mask(EnvState::running);
    note(
        r, [this](Index e) { return wanted(e); }, judged, report);
    for (Index e = 0; e < envs_.size(); ++e)
      if (judged[e] && envs_[e].whole) report[e].lag_residual = report[e].residual, report[e].relative_lag_residual = report[e].relative_residual;
    trace_.begin(info, std::as_const(q_).view(), r, it, at_, judged, report);
    outlook_.look(
        r, it, [this](Index e) { return wanted(e); }, envs_, q_);
    check_failed();
    const EnvMask running = envs_.mask(EnvState::running);
    if (!any(running)) {
      last_ = it;
      return;
    }
    const model::Only left(model_, running);

    std::vector<double> tolerance;
    for (Index e = 0; e < envs_.size(); ++e) tolerance.push_back(system_.convergence.least_tolerance(r, e, wanted(e)));
    for (Index e = 0; e < envs_.size(); ++e)
      if (running[e]) {
        const double force = system_.convergence.largest_force(r, e);
        envs_[e].stretch = envs_[e].circles ? tuning::kBetween : system_.slides(e) ? 1 : saddle_.choose(e, envs_[e].alpha, envs_[e].concave, force);
      }
    // What is told of the direction comes with how far it may lead.
    device::Fetch fetch;
    const bool asked = direction_.begin(q_, r, tolerance, at_, envs_, report, fetch, ask_of_way());
    held_ = running;
    check_failed();
    line_search_.begin(std::as_const(q_).view(), direction_.way(), direction_.supports(), at_, envs_, fetch, asked);
    direction_.end(envs_);
    check_failed();
    const Search::Forces forces = forces_beside(r);
    line_search_.end(q_, direction_.way(), direction_.slope(), at_, envs_, report, forces);
    foreseen_ = line_search_.landed();
    check_failed();
    for (Index e = 0; e < envs_.size(); ++e) {
      if (!envs_.is(e, EnvState::running) || envs_[e].alpha > 0) continue;
      if (forces.refused[e])
        system_.hold.hold_firmly(e, system_.convergence.largest_force(r, e), r.support_gap[e]);
      else
        system_.hold.tighten(e), ++envs_[e].refused;
    }
    for (Index e = 0; e < envs_.size(); ++e) {
      if (!envs_.is(e, EnvState::running)) continue;
      envs_[e].force = system_.convergence.largest_force(r, e), envs_[e].sum = system_.convergence.loose_sum(r, e),
      envs_[e].concave = curvature_.concavity(e);
      moving_.see(e, envs_[e].force);
    }
    for (Index e = 0; e < envs_.size(); ++e) report[e].newton += running[e];
    trace_.end(envs_, running, {}, report);
  }
}

std::function<void(device::Fetch&)> Newton::ask_of_way() {
  return [this](device::Fetch& fetch) { line_search_.ask(std::as_const(q_).view(), direction_.way(), direction_.supports(), at_, fetch); };
}

// What the line search may ask of forces at states beside q, where the residual is r.
Newton::Search::Forces Newton::forces_beside(const Residual& r) {
  Search::Forces out;
  out.closer = [this, &r](const device::Buffer<Vec3>& trial, const EnvMask& whose) {
    const Residual there = system_.linearise(std::as_const(trial).view(), {}, beside_, true);
    EnvMask closer(envs_.size(), 0);
    for (Index e = 0; e < envs_.size(); ++e)
      closer[e] = whose[e] && system_.convergence.finite(there, e) && there.support_gap[e] == 0 &&
                  system_.convergence.over(there, e, wanted(e)) <
                      (envs_[e].whole || !envs_[e].moving ? tuning::kCloser : tuning::kMuchCloser) * system_.convergence.over(r, e, wanted(e));
    return closer;
  };
  out.slope = [this](const device::Buffer<Vec3>& trial, const EnvMask&) {
    system_.potential.linearise(std::as_const(trial).view(), {}, beside_, true);
    return dot(std::as_const(beside_.gradient).view(), std::as_const(direction_.way()).view(), model_.env_blocks);
  };
  out.astray = [this, &r](const device::Buffer<Vec3>& trial, const EnvMask& whose) {
    const Residual there = system_.linearise(std::as_const(trial).view(), {}, beside_, true);
    EnvMask astray(envs_.size(), 0);
    for (Index e = 0; e < envs_.size(); ++e)
      astray[e] = whose[e] && (!system_.convergence.finite(there, e) ||
                               system_.hold.astray(e, system_.convergence.largest_force(r, e), system_.convergence.largest_force(there, e)));
    return astray;
  };
  out.refused.assign(envs_.size(), 0);
  for (Index e = 0; e < envs_.size(); ++e)
    out.refused[e] =
        envs_.is(e, EnvState::running) && system_.rows.loose[e] && r.support_gap[e] > 0 && system_.hold.flees(e, envs_[e].step, system_.length[e]);
  out.far.assign(envs_.size(), 0);
  for (Index e = 0; e < envs_.size(); ++e)
    out.far[e] = envs_.is(e, EnvState::running) && held_loosely(e) && r.support_gap[e] == 0 && system_.hold.far(e, left(r, e), envs_[e].step);
  // Forces of a state by itself are not the slope of energies with something frozen.
  out.doubtful.assign(envs_.size(), 0);
  for (Index e = 0; e < envs_.size(); ++e)
    out.doubtful[e] = envs_[e].force > 0 && system_.convergence.largest_force(r, e) > tuning::kCloser * envs_[e].force &&
                      (envs_[e].whole || !system_.potential.lags()) && !system_.potential.freezes() && !model_.ties.driven();
  return out;
}

// The coupled iteration, for environments that are stuck, and for those that some rounds of lagged quantities have not brought to an end. Where it
// fails too, the others' way is gone on from the best state.
void Newton::couple(Index round, const effects::StepInfo& info, const StepReports& report, const std::function<void()>& stop) {
  for (Index e = 0; e < envs_.size(); ++e)
    if (round >= tuning::kPlainRounds && envs_.is(e, EnvState::settled) && envs_[e].may_couple && envs_[e].coupled == 0)
      envs_[e].state = EnvState::stuck;
  for (bool first = round == 0; envs_.any(EnvState::stuck); first = false) {
    // Differences of forces would give no better directions than H + U where that is all; and the coupled iteration moves no supports.
    for (Index e = 0; e < envs_.size(); ++e)
      if (envs_.is(e, EnvState::stuck) && envs_[e].whole && (!system_.potential.freezes() || !envs_[e].arrived)) freeze(e);
    if (envs_.any(EnvState::stuck)) solve_coupled(info, report, stop);
    for (Index e = 0; e < envs_.size(); ++e) {
      if (!envs_.is(e, EnvState::stuck)) continue;
      if (!envs_[e].whole) {
        envs_[e].couple_below = tuning::kNearer * outlook_.nearest(e);
        envs_[e].may_couple = ++envs_[e].coupled < tuning::kMostCoupled;
      }
      freeze(e);
    }
    if (!envs_.any(EnvState::running)) return;
    // All that lag from now on begin to together, from their own states.
    if (first)
      lag_here(envs_.mask(EnvState::running));
    else
      hold(envs_.mask(EnvState::running));
    iterate(info, report, stop);
  }
}

void Newton::solve_coupled(const effects::StepInfo& info, const StepReports& report, const std::function<void()>& stop) {
  const EnvMask took_part = envs_.mask(EnvState::stuck);
  const Coupled::Watch watch{[&](const Residual& r, Index iteration, const EnvMask& whose) {
                               note(
                                   r, [this](Index) { return lag_.wanted(); }, whose, report);
                               trace_.begin(info, std::as_const(q_).view(), r, iteration, at_, whose, report);
                             },
                             [&](const EnvMask& whose, const std::vector<Index>& products) { trace_.end(envs_, whose, products, report); }};
  for (Index e = 0; e < envs_.size(); ++e)
    if (envs_.is(e, EnvState::stuck)) energies_.forget(e);
  coupled_.solve(q_, lag_.wanted(), at_, beside_, envs_, report, stop, watch);
  held_.assign(envs_.size(), 0);
  check_failed();
  for (Index e = 0; e < envs_.size() && system_.potential.lags(); ++e)
    if (took_part[e]) report[e].lag_residual = report[e].residual, report[e].relative_lag_residual = report[e].relative_residual;
}

// From here on with rounds of lagged quantities.
void Newton::freeze(Index env) {
  envs_[env].whole = false;
  envs_[env].state = EnvState::running;
  lag_.restart(env, q_);
}

// What is frozen becomes that of the settled environments' states; those that are solved with it too are done. False when there is nothing left
// to do.
bool Newton::refresh(Index round, const StepReports& report) {
  const EnvMask settled = envs_.mask(EnvState::settled);
  if (!any(settled)) return false;
  if (!system_.potential.lags()) {
    envs_.change(EnvState::settled, EnvState::solved);
    return false;
  }
  for (Index e = 0; e < envs_.size(); ++e) report[e].lag += settled[e];
  hold(settled);
  const model::Only only(model_, settled);
  held_ = settled;
  system_.find_groups(at_, settled);
  system_.potential.lag(at_, at_);
  const Residual fresh = system_.linearise(std::as_const(q_).view(), {}, at_);
  system_.convergence.refreshed();
  for (Index e = 0; e < envs_.size(); ++e) {
    if (!settled[e]) continue;
    report[e].lag_residual = report[e].relative_lag_residual = 0;
    envs_[e].force = 0;
    if (!system_.convergence.finite(fresh, e)) {
      envs_.fail(e, system_.not_finite(at_, e));
      continue;
    }
    const double residual = system_.convergence.largest_force(fresh, e), relative = system_.convergence.relative_residual(fresh, e);
    report[e].lag_residual = residual, report[e].relative_lag_residual = relative;
    if (system_.solved(fresh, e, lag_.wanted(), envs_[e].step)) {
      envs_[e].state = EnvState::solved;
      continue;
    }
    lag_.refreshed(e, relative);
    envs_[e].state = EnvState::running;
    if (round < options_.lag_iterations && !(may_cut_ && lag_.idle(e))) continue;
    std::ostringstream why;
    why << "lagged quantities (friction) did not settle in " << round << " rounds: residual " << residual << " N";
    envs_.fail(e, why.str());
  }
  check_failed();
  if (!envs_.any(EnvState::running)) return false;
  const model::Only left(model_, envs_.mask(EnvState::running));
  lag_.relax(q_, envs_.mask(EnvState::running), beside_, at_);
  return true;
}

void Newton::note(const Residual& r, const std::function<double(Index)>& relative, const EnvMask& whose, const StepReports& report) const {
  for (Index e = 0; e < envs_.size(); ++e) {
    if (!whose[e]) continue;
    const Convergence::Worst worst = system_.convergence.worst(r, e, relative(e));
    report[e].residual = worst.force, report[e].tolerance = worst.tolerance;
    report[e].relative_residual = system_.convergence.relative_residual(r, e);
  }
}

}  // namespace mortise::solver
