#include "solver/simulation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <sstream>

#include "base/env_archives.h"
#include "base/memory_archive.h"
#include "effects/per_environment.h"
#include "solver/flatten.h"
#include "solver/kernels.h"
#include "solver/timed.h"
#include "solver/tuning.h"
#include "solver/unsupported.h"

namespace mortise::solver {
namespace {

// What StepInfo says of them: nothing where all do.
EnvMask some_of(const EnvMask& whose) { return std::find(whose.begin(), whose.end(), 0) == whose.end() ? EnvMask{} : whose; }

}  // namespace

void AcceptedForces::accept(const effects::StepInfo& info, const Linearised& at, const model::Model& model) {
  own_ = model.envs > 1;
  if (!own_) return;
  const auto copy = [&](const device::Buffer<Vec3>& from, device::Buffer<Vec3>& to) {
    if (to.size() != from.size()) to.copy_from(from);
    copy_envs(from, info.whose.empty() ? EnvMask(model.envs, 1) : info.whose, model.env_blocks, to);
  };
  gradients_.resize(at.gradients.size());
  for (std::size_t k = 0; k < gradients_.size(); ++k) copy(at.gradients[k], gradients_[k]);
  copy(at.gradient, gradient_);
}

Simulation::Simulation(model::Model& model, EffectList& effects, const Options& options)
    : model_(model),
      effects_(effects),
      options_(options),
      newton_(model, effects, options_, clock_),
      lost_(model.envs),
      resting_(model.envs, 0),
      solved_(model.envs, 0),
      support_work_(model.envs, 0.0),
      work_lag_(model.envs, 0.0),
      time_(model.envs, 0.0),
      step_(model.envs, 0) {}

// The minimisers of the environments of `whose`, of effects whose parameters fit them, and states of the model: `why` says where there is none.
void Simulation::solve(const effects::StepInfo& info, const EnvMask& whose, const StepReports& report, const std::function<void()>& stop,
                       std::vector<std::string>& why) {
  using Refit = effects::Effect::Refit;
  const auto note_failed = [&] {
    for (Index e = 0; e < model_.envs; ++e)
      if (whose[e] && why[e].empty() && newton_.envs().is(e, EnvState::failed)) why[e] = newton_.envs()[e].reason;
  };
  refitted_ = false;
  newton_.begin(whose);
  newton_.solve(info, report, stop, whose);
  note_failed();
  for (int fits = 0; fits < tuning::kMostFits; ++fits) {
    std::vector<Refit> refit(model_.envs, Refit::none);
    for (std::size_t k = 0; k < effects_.size(); ++k) effects_[k]->refit(newton_.q().view(), *newton_.at().of[k], refit);
    EnvMask anew(model_.envs, 0), afresh(model_.envs, 0);
    for (Index e = 0; e < model_.envs; ++e) {
      if (!whose[e] || !why[e].empty()) continue;
      anew[e] = refit[e] != Refit::none;
      afresh[e] = refit[e] == Refit::from_start;
    }
    if (!any(anew)) break;
    refitted_ = true;
    if (any(afresh)) newton_.begin(afresh);
    newton_.solve(info, report, stop, anew);
    note_failed();
  }
  std::vector<std::string> objections(model_.envs);
  for (const auto& effect : effects_) effect->object(newton_.q().view(), objections);
  for (Index e = 0; e < model_.envs; ++e)
    if (whose[e] && why[e].empty()) why[e] = objections[e];
}

std::vector<double> Simulation::lost_energy(const effects::StepInfo& info) const {
  std::vector<double> lost(model_.envs, 0.0);
  for (Index e = 0; e < model_.envs; ++e)
    if (info.taken_by(e)) lost[e] = options_.is_static ? INFINITY : std::max(-newton_.energies().of_step(e).gain, 0.0);
  return lost;
}

// info.whose: the environments that accept.
void Simulation::accept(const effects::StepInfo& info, const std::vector<double>& lost) {
  const EnvMask whose = info.whose.empty() ? EnvMask(model_.envs, 1) : info.whose;
  const model::Only only(model_, whose);
  copy_envs(newton_.q(), whose, model_.env_blocks, model_.q);
  for (Index e = 0; e < model_.envs; ++e) {
    if (!info.taken_by(e)) continue;
    const StepEnergy& energy = newton_.energies().of_step(e);
    support_work_[e] += energy.work, work_lag_[e] += energy.work_lag;
    solved_[e] = 1;
  }
  newton_.accept(whose);
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    const Timed timed(clock_, effects_[k]->name(), "end_step");
    effects_[k]->end_step(info, model_.q.view(), *newton_.at().of[k]);
  }
  for (std::size_t k = 0; k < effects_.size(); ++k) effects_[k]->adapt(info, lost, *newton_.at().of[k]);
  forces_.accept(info, newton_.at(), model_);
}

void Simulation::begin() {
  effects::StepInfo info{time_[0], options_.dt, step_[0], options_.is_static};
  if (model_.envs > 1) info.begins = time_;
  for (long parts = 1;; parts *= 2) try {  // a part that can be taken, as steps are
      info.dt = options_.dt / static_cast<double>(parts);
      for (const auto& effect : effects_) effect->integrate(info);
      for (const auto& effect : effects_) effect->begin_step(info);
      return;
    } catch (const Failure& failure) {
      if (parts == 1L << options_.halvings) throw Error(Exit::solve, failure.reason);
    }
}

// Begins the step of the environments of `whose` and solves it. One that cannot take it at all leaves the others' way as if it had never been tried.
void Simulation::attempt(effects::StepInfo info, EnvMask whose, const StepReports& report, const std::function<void()>& stop,
                         std::vector<std::string>& why) {
  while (any(whose)) {
    const std::vector<StepReport> before = model_.envs > 1 && !report.shared() ? report.kept() : std::vector<StepReport>{};
    info.whose = some_of(whose);
    const model::Only only(model_, whose);
    try {
      for (const auto& effect : effects_) {
        const Timed timed(clock_, effect->name(), "begin_step");
        effect->begin_step(info);
      }
      return solve(info, whose, report, stop, why);
    } catch (const Failure& failure) {
      why[failure.env] = failure.reason;
      whose[failure.env] = 0;
      for (Index e = 0; e < model_.envs && !before.empty(); ++e)
        if (whose[e]) report[e] = before[e], why[e].clear();
    }
  }
}

void Simulation::step(const std::function<bool()>& stop_asked, const StepReports& report) {
  const auto start = std::chrono::steady_clock::now();
  for (Index e = 0; e < model_.envs; ++e) {
    report[e] = {};
    report[e].step = step_[e];
    report[e].dt = options_.dt;
    report[e].substeps = 0;
  }
  for (std::vector<double>* sum : {&support_work_, &work_lag_}) sum->assign(model_.envs, 0.0);
  for (Simulation* other : others_)
    for (std::vector<double>* sum : {&other->support_work_, &other->work_lag_}) sum->assign(1, 0.0);

  // The step is cut into 2^halvings units, so that substeps always meet its end exactly; every environment cuts it by itself.
  struct Cut {
    long done = 0, size = 0;
    EnergyGuard guard;
    bool first_order = false;  // the step under way
    bool sets_out = false;     // pins let go where the step begins
  };
  const long units = 1L << options_.halvings;
  std::vector<Cut> cuts(model_.envs);
  // Where a run begins there is no history, and where pins let go it is none of what they held: steps of second order begin with a short one of
  // first.
  effects::StepInfo whole{time_[0], options_.dt, step_[0], options_.is_static};
  if (model_.envs > 1) whole.begins = time_;
  for (const auto& effect : effects_) effect->integrate(whole);
  const auto of_any = [&](const auto& what) { return std::any_of(effects_.begin(), effects_.end(), what); };
  for (Index e = 0; e < model_.envs; ++e) {
    cuts[e].sets_out = whole.integrator(e).a2 != 0 && of_any([&](const auto& effect) { return effect->lets_go(whole, e); });
    const bool begins = cuts[e].sets_out || of_any([&](const auto& effect) { return effect->starts(e); });
    cuts[e].size = begins ? std::max(units >> tuning::kStartHalvings, 1L) : units;
  }
  EnvMask takes(model_.envs, 1);
  for (Index e = 0; e < model_.envs; ++e)
    if (!lost_[e].empty() || resting_[e]) cuts[e].done = units, takes[e] = 0;
  const double gain = newton_.potential().symmetric() ? tuning::kGainShare : tuning::kFrozenGainShare;
  std::vector<MemoryArchive> before;  // set before the first substep that is not the whole step is accepted; of several environments at once
  const auto remember = [&] {
    if (!before.empty()) return;
    before.resize(model_.envs);
    std::vector<Archive*> all;
    for (MemoryArchive& a : before) all.push_back(&a);
    checkpoint(all);
  };
  const auto undo = [&](const EnvMask& whose) {
    if (before.empty()) return;
    std::vector<Archive*> some(model_.envs, nullptr);
    for (Index e = 0; e < model_.envs; ++e)
      if (whose[e]) before[e].rewind(), some[e] = &before[e];
    if (any(whose)) checkpoint(some);
  };
  const auto stop = [&] {
    if (stop_asked && stop_asked()) throw Stopped{};
  };
  if (model_.envs > 1) remember();

  for (;;) {
    // Those that are farthest behind and have as far to go.
    const Cut* next = nullptr;
    for (const Cut& c : cuts)
      if (c.done < units && (!next || c.done < next->done)) next = &c;
    if (!next) break;
    const long done = next->done, size = next->size;
    EnvMask whose;
    for (const Cut& c : cuts) whose.push_back(c.done == done && c.size == size);
    const double offset = options_.dt * (static_cast<double>(done) / units);
    effects::StepInfo info{time_[next - cuts.data()] + offset, options_.dt * (static_cast<double>(size) / units), step_[next - cuts.data()],
                           options_.is_static};
    for (Index e = 0; e < model_.envs && model_.envs > 1; ++e) info.begins.push_back(time_[e] + offset);
    for (const Cut& c : cuts) info.first_order.push_back(c.first_order || (c.sets_out && c.done == 0));
    for (const auto& effect : effects_) effect->integrate(info);
    std::vector<std::string> why(model_.envs);
    newton_.may_cut(size > 1);
    try {
      attempt(info, whose, report, stop, why);
    } catch (const Stopped&) {
      undo(takes);
      throw;
    }
    EnvMask accepted(model_.envs, 0);
    for (Index e = 0; e < model_.envs; ++e) {
      if (!whose[e]) continue;
      const StepEnergy& energy = newton_.energies().of_step(e);
      if (why[e].empty() && energy.second_order && energy.gain > energy.may_gain(tuning::kSecondOrderGainShare)) {
        cuts[e].first_order = true;
      } else if (size > 1 && (!why[e].empty() || (!energy.second_order && cuts[e].guard.wants_halving(energy, gain)))) {
        cuts[e].size /= 2;
      } else if (!why[e].empty()) {
        std::ostringstream message;
        message << "step " << step_[e] + 1 << " (t = " << info.t0_of(e) << " s, dt = " << info.dt << " s) failed: " << why[e];
        if (options_.is_static) message << unsupported(model_, e);
        lost_[e] = message.str();
        cuts[e].done = units;
      } else {
        accepted[e] = 1;
      }
    }
    // Of the environments that are given up nothing has happened.
    EnvMask failed(model_.envs, 0);
    bool left = false;
    for (Index e = 0; e < model_.envs; ++e) failed[e] = whose[e] && !lost_[e].empty(), left = left || (takes[e] && lost_[e].empty());
    if (any(failed)) undo(failed);
    if (!left) {  // the only environment, or the last
      const std::string message = lost_[std::find(takes.begin(), takes.end(), 1) - takes.begin()];
      if (model_.envs == 1) lost_[0].clear();
      throw Error(Exit::solve, message);
    }
    if (!any(accepted)) continue;
    if (size < units) remember();
    info.whose = some_of(accepted);
    if (!others_.empty()) try {
        lead_on(info);
      } catch (const Failure& failure) {
        undo(takes);
        throw Error(Exit::solve, failure.reason);
      }
    accept(info, lost_energy(info));
    for (Index e = 0; e < model_.envs; ++e) {
      if (!accepted[e]) continue;
      ++report[e].substeps;
      Cut& c = cuts[e];
      c.guard.accepted();
      report[e].first_order += c.first_order;
      c.first_order = false;
      c.done += size;
      const bool fits = size < units && c.done % (2 * size) == 0;
      if (fits && c.guard.lets_double(newton_.energies().of_step(e), gain)) c.size *= 2;
    }
  }

  newton_.hold(takes);
  newton_.end_step(takes);
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (Index e = 0; e < model_.envs; ++e) {
    if (!takes[e] || !lost_[e].empty()) continue;
    ++step_[e];
    time_[e] = options_.dt * step_[e];
    report[e].time = time_[e];
    report[e].wall = wall;
  }
  for (Simulation* other : others_) other->step_ = step_, other->time_ = time_;
}

void Simulation::checkpoint(const std::vector<Archive*>& of) {
  EnvArchives archive(of);
  const std::vector<std::size_t> each = effects::one_each(model_.envs);
  std::vector<double> step(step_.begin(), step_.end());
  archive.io("step", step, each);
  archive.io("time", time_, each);
  step_.assign(step.begin(), step.end());
  std::vector<double> q = flatten(model_.q.download());
  archive.io("q", q, effects::in_values(model_.env_blocks, 3));
  if (archive.loading()) {
    if (q.size() != 3 * static_cast<std::size_t>(model_.blocks))
      throw Error(Exit::file, "the checkpoint belongs to another scene: it has " + std::to_string(q.size() / 3) + " blocks, the scene " +
                                  std::to_string(model_.blocks));
    model_.q.upload(unflatten(q));
    for (Index e = 0; e < model_.envs; ++e)
      if (of[e]) solved_[e] = 0;
  }
  for (const auto& effect : effects_) {
    PrefixedArchive part(archive, std::string(effect->name()));
    effect->checkpoint(part);
  }
  PrefixedArchive part(archive, "solver");
  newton_.checkpoint(part);
}

}  // namespace mortise::solver
