#include "solver/simulation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <sstream>

#include "base/memory_archive.h"
#include "base/pass_on.h"
#include "solver/kernels.h"
#include "solver/tie_forces.h"
#include "solver/timed.h"
#include "solver/tuning.h"
#include "solver/unsupported.h"

namespace mortise::solver {
namespace {

// Hands on what an effect reports, and sums its forces on points by body.
class WrittenForces : public PassOn {
 public:
  WrittenForces(FieldSink& next, const model::Model& model) : PassOn(&next), model_(model), sum_(model.bodies.size(), Vec3::Zero()) {}
  void points(std::string_view name, std::string_view unit, int components, std::span<const double> values) override {
    PassOn::points(name, unit, components, values);
    if (unit != "N" || components != 3) return;
    any_ = true;
    for (std::size_t i = 0; i < sum_.size(); ++i)
      for (Index p = model_.bodies[i].point_begin; p < model_.bodies[i].point_end; ++p)
        for (int c = 0; c < 3; ++c) sum_[i][c] += values[3 * static_cast<std::size_t>(p) + c];
  }
  bool any() const { return any_; }
  const std::vector<Vec3>& sum() const { return sum_; }

 private:
  const model::Model& model_;
  std::vector<Vec3> sum_;
  bool any_ = false;
};

std::vector<double> flatten(const std::vector<Vec3>& v) {
  std::vector<double> out;
  out.reserve(3 * v.size());
  for (const Vec3& x : v) out.insert(out.end(), {x[0], x[1], x[2]});
  return out;
}

std::vector<Vec3> unflatten(const std::vector<double>& v) {
  std::vector<Vec3> out(v.size() / 3);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
  return out;
}

// What StepInfo says of them: nothing where all do.
EnvMask some_of(const EnvMask& whose) { return std::find(whose.begin(), whose.end(), 0) == whose.end() ? EnvMask{} : whose; }

}  // namespace

void AcceptedForces::accept(const effects::StepInfo& info, const Linearised& at, const model::Model& model) {
  own_ = model.envs > 1;
  if (!own_) return;
  const auto copy = [&](const device::Buffer<Vec3>& from, device::Buffer<Vec3>& to) {
    if (to.size() != from.size()) to.copy_from(from);
    for (Index e = 0; e < model.envs; ++e)
      if (info.taken_by(e)) copy_blocks(from, model.env_blocks[e], model.env_blocks[e + 1], to);
  };
  gradients_.resize(at.gradients.size());
  for (std::size_t k = 0; k < gradients_.size(); ++k) copy(at.gradients[k], gradients_[k]);
  copy(at.gradient, gradient_);
}

Simulation::Simulation(model::Model& model, EffectList& effects, const Options& options)
    : model_(model), effects_(effects), options_(options), newton_(model, effects, options_, clock_), lost_(model.envs) {}

// The minimisers of the environments of `whose`, of effects whose parameters fit them, and states of the model: `why` says where there is none.
void Simulation::solve(const effects::StepInfo& info, const EnvMask& whose, StepReport& report, const std::function<void()>& stop,
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
  for (Index e = 0; e < model_.envs; ++e) {
    if (!info.taken_by(e)) continue;
    copy_blocks(newton_.q(), model_.env_blocks[e], model_.env_blocks[e + 1], model_.q);
    support_work_ += newton_.energies().of_step(e).work;
  }
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    const Timed timed(clock_, effects_[k]->name(), "end_step");
    effects_[k]->end_step(info, model_.q.view(), *newton_.at().of[k]);
  }
  for (std::size_t k = 0; k < effects_.size(); ++k) effects_[k]->adapt(info, lost, *newton_.at().of[k]);
  forces_.accept(info, newton_.at(), model_);
  solved_ = true;
}

void Simulation::begin() {
  const effects::StepInfo info{time_, options_.dt, step_, options_.is_static};
  for (const auto& effect : effects_) effect->begin_step(info);
}

void Simulation::step(const std::function<bool()>& stop_asked, StepReport& report) {
  const auto start = std::chrono::steady_clock::now();
  report = {};
  report.step = step_;
  report.dt = options_.dt;
  report.substeps = 0;
  support_work_ = 0;
  for (Simulation* other : others_) other->support_work_ = 0;

  // The step is cut into 2^halvings units, so that substeps always meet its end exactly; every environment cuts it by itself.
  struct Cut {
    long done = 0, size = 0;
    EnergyGuard guard;
    bool first_order = false;  // the step under way
  };
  const long units = 1L << options_.halvings;
  std::vector<Cut> cuts(model_.envs);
  for (Cut& c : cuts) c.size = units;
  for (Index e = 0; e < model_.envs; ++e)
    if (!lost_[e].empty()) cuts[e].done = units;
  const double gain = newton_.potential().symmetric() ? tuning::kGainShare : tuning::kFrozenGainShare;
  device::Buffer<Vec3> q_before;
  q_before.copy_from(model_.q);
  std::optional<MemoryArchive> before;  // set once a substep was accepted
  const auto undo = [&] {
    if (!before) return;
    before->rewind();
    checkpoint(*before);
  };
  const auto stop = [&] {
    if (stop_asked && stop_asked()) throw Stopped{};
  };

  for (;;) {
    // Those that are farthest behind and have as far to go.
    const Cut* next = nullptr;
    for (const Cut& c : cuts)
      if (c.done < units && (!next || c.done < next->done)) next = &c;
    if (!next) break;
    const long done = next->done, size = next->size;
    EnvMask whose;
    for (const Cut& c : cuts) whose.push_back(c.done == done && c.size == size);
    effects::StepInfo info{time_ + options_.dt * (static_cast<double>(done) / units), options_.dt * (static_cast<double>(size) / units), step_,
                           options_.is_static};
    info.whose = some_of(whose);
    for (const Cut& c : cuts) info.first_order.push_back(c.first_order);
    std::vector<std::string> why(model_.envs);
    try {
      for (const auto& effect : effects_) {
        const Timed timed(clock_, effect->name(), "begin_step");
        effect->begin_step(info);
      }
      solve(info, whose, report, stop, why);
    } catch (const Stopped&) {
      undo();
      throw;
    } catch (const Failure& failure) {
      for (Index e = 0; e < model_.envs; ++e)
        if (whose[e]) why[e] = failure.reason;
    }
    EnvMask accepted(model_.envs, 0);
    for (Index e = 0; e < model_.envs; ++e) {
      if (!whose[e]) continue;
      const StepEnergy& energy = newton_.energies().of_step(e);
      if (why[e].empty() && energy.second_order && energy.gain > tuning::kSecondOrderGainShare * energy.there) {
        cuts[e].first_order = true;
      } else if (size > 1 && (!why[e].empty() || (!energy.second_order && cuts[e].guard.wants_halving(energy, gain)))) {
        cuts[e].size /= 2;
      } else if (!why[e].empty()) {
        std::ostringstream message;
        message << "step " << step_ << " (t = " << info.t0 << " s, dt = " << info.dt << " s) failed: " << why[e];
        if (options_.is_static) message << unsupported(model_);
        lost_[e] = message.str();
        cuts[e].done = units;
        copy_blocks(q_before, model_.env_blocks[e], model_.env_blocks[e + 1], model_.q);
      } else {
        accepted[e] = 1;
      }
    }
    // The only environment, or the last: nothing has happened.
    if (std::none_of(lost_.begin(), lost_.end(), [](const std::string& m) { return m.empty(); })) {
      undo();
      const std::string message = lost_[0];
      if (model_.envs == 1) lost_[0].clear();
      throw Error(Exit::solve, message);
    }
    if (!any(accepted)) continue;
    if (size < units && !before) {
      before.emplace();
      checkpoint(*before);
    }
    info.whose = some_of(accepted);
    if (!others_.empty()) try {
        lead_on(info);
      } catch (const Failure& failure) {
        undo();
        throw Error(Exit::solve, failure.reason);
      }
    accept(info, lost_energy(info));
    ++report.substeps;
    for (Index e = 0; e < model_.envs; ++e) {
      if (!accepted[e]) continue;
      Cut& c = cuts[e];
      c.guard.accepted();
      report.first_order += c.first_order;
      c.first_order = false;
      c.done += size;
      if (size < units && c.done % (2 * size) == 0) c.size *= 2;
    }
  }

  ++step_;
  time_ = options_.dt * step_;
  for (Simulation* other : others_) other->step_ = step_, other->time_ = time_;
  report.time = time_;
  report.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void Simulation::report(FieldSink& sink) {
  device::Buffer<Vec3> y;
  model_.points_of(model_.q.view(), y);
  std::vector<Vec3> u = y.download();
  const std::vector<Vec3> rest = model_.rest_points.download();
  for (std::size_t i = 0; i < u.size(); ++i) u[i] -= rest[i];
  sink.points("displacement", "m", 3, flatten(u));
  if (solved_) report_balance(sink);
  // Before the first step, and after a restart, nothing has been evaluated at this state yet.
  if (!solved_) newton_.begin(EnvMask(model_.envs, 1));
  double unlike = 0;
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    const Timed timed(clock_, effects_[k]->name(), "report");
    WrittenForces written(sink, model_);
    effects_[k]->report(written, *newton_.at().of[k]);
    if (!solved_ || !written.any()) continue;
    const std::vector<Vec3> sum = resultants(forces_.of(k, newton_.at()).download());
    for (std::size_t i = 0; i < sum.size(); ++i) unlike = std::max(unlike, (written.sum()[i] + sum[i]).norm());
  }
  if (solved_) sink.scalar("balance", "written_defect", "N", unlike);
}

// Sum over the blocks of every body that carry translation: its nodes, or the position block of a stiff body.
std::vector<Vec3> Simulation::resultants(const std::vector<Vec3>& g) const {
  std::vector<Vec3> sum;
  for (const model::Body& body : model_.bodies) {
    sum.push_back(Vec3::Zero());
    const Index end = body.type == model::BodyType::stiff ? body.block_begin + 1 : body.block_end;
    for (Index b = body.block_begin; b < end; ++b) sum.back() += g[b];
  }
  return sum;
}

// Newton's first law of the accepted state: over all blocks that carry translation (nodes, and the position block of stiff
// bodies) the forces of all effects and of the supports sum to zero.
void Simulation::report_balance(FieldSink& sink) {
  const auto resultant = [](const std::vector<Vec3>& sums) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& s : sums) sum += s;
    return sum;
  };
  const auto put = [&](const std::string& name, const Vec3& f) {
    for (int k = 0; k < 3; ++k) sink.scalar("balance", name + "_" + "xyz"[k], "N", f[k]);
  };

  Vec3 total = Vec3::Zero();
  std::vector<Vec3> load(model_.bodies.size(), Vec3::Zero());  // of all effects and ties
  double largest = 0;                                          // of one effect on one body
  std::optional<TieForces> ties;
  if (model_.ties.any()) {
    std::vector<Vec3> all(model_.blocks, Vec3::Zero());
    for (std::size_t k = 0; k < effects_.size(); ++k) {
      const std::vector<Vec3> g = forces_.of(k, newton_.at()).download();
      for (std::size_t b = 0; b < all.size(); ++b) all[b] += g[b];
    }
    ties.emplace(model_, model_.q.download(), std::move(all));
    load = ties->on_bodies();
    ties->report(sink);
  }
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    const std::vector<Vec3> sums = resultants(forces_.of(k, newton_.at()).download());
    Vec3 f = -resultant(sums);
    if (effects_[k]->kind().role == effects::Role::tie) f = ties->of_effect(effects_[k]->name());
    put(std::string(effects_[k]->name()), f);
    total += f;
    for (std::size_t i = 0; i < load.size(); ++i) {
      load[i] -= sums[i];
      largest = std::max(largest, sums[i].norm());
    }
  }
  sink.scalar("balance", "largest", "N", largest);

  // The support's force on a held block is what the effects leave over there, in the held directions.
  const std::vector<Vec3> g = forces_.sum(newton_.at()).download();
  const std::vector<Mat3> P = model_.projector.download();
  std::vector<Vec3> reaction(g.size());
  for (std::size_t b = 0; b < g.size(); ++b) reaction[b] = g[b] - P[b] * g[b];
  const std::vector<Vec3> supports = resultants(reaction);
  const Vec3 support = resultant(supports);
  put("support", support);
  put("defect", total + support);

  if (newton_.energies().measures()) sink.scalar("supports", "work", "J", support_work_);
  bool any = false;
  std::vector<double> field(3 * static_cast<std::size_t>(model_.points), 0.0);
  for (const model::Body& body : model_.bodies) {
    const Vec3& sum = supports[&body - model_.bodies.data()];
    bool held = false;
    for (Index b = body.block_begin; b < body.block_end; ++b) {
      if (!model_.held[b] || model_.held[b] == model::Model::kTied) continue;
      held = any = true;
      if (body.type != model::BodyType::soft) continue;
      const std::size_t point = body.point_begin + (b - body.block_begin);
      for (int k = 0; k < 3; ++k) field[3 * point + k] = reaction[b][k];
    }
    if (!held) continue;
    for (int k = 0; k < 3; ++k) sink.scalar("supports", body.name + "_" + "xyz"[k], "N", sum[k]);
    sink.scalar("supports", body.name + "_defect", "N", (sum + load[&body - model_.bodies.data()]).norm());  // what they do not bear
  }
  if (any) sink.points("support_force", "N", 3, field);
}

void Simulation::checkpoint(Archive& archive) {
  double step = step_;
  archive.io("step", step);
  archive.io("time", time_);
  step_ = static_cast<Index>(step);
  std::vector<double> q = archive.loading() ? std::vector<double>{} : flatten(model_.q.download());
  archive.io("q", q);
  if (archive.loading()) {
    if (q.size() != 3 * static_cast<std::size_t>(model_.blocks))
      throw Error(Exit::file, "the checkpoint belongs to another scene: it has " + std::to_string(q.size() / 3) + " blocks, the scene " +
                                  std::to_string(model_.blocks));
    model_.q.upload(unflatten(q));
    solved_ = false;
  }
  for (const auto& effect : effects_) {
    PrefixedArchive part(archive, std::string(effect->name()));
    effect->checkpoint(part);
  }
}

}  // namespace mortise::solver
