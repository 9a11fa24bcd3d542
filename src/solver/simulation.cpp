#include "solver/simulation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <sstream>

#include "base/memory_archive.h"
#include "base/pass_on.h"
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

}  // namespace

Simulation::Simulation(model::Model& model, EffectList& effects, const Options& options)
    : model_(model), effects_(effects), options_(options), newton_(model, effects, options_, clock_) {}

// The minimiser, of effects whose parameters fit it, and a state of the model.
void Simulation::solve(const effects::StepInfo& info, StepReport& report, const std::function<void()>& stop) {
  using Refit = effects::Effect::Refit;
  const EnvMask all(model_.envs, 1);
  newton_.begin(all);
  newton_.solve(info, report, stop, all);
  for (int fits = 0; fits < tuning::kMostFits; ++fits) {
    std::vector<Refit> refit(model_.envs, Refit::none);
    for (std::size_t k = 0; k < effects_.size(); ++k) effects_[k]->refit(newton_.q().view(), *newton_.at().of[k], refit);
    EnvMask anew, afresh;
    for (Refit how : refit) anew.push_back(how != Refit::none), afresh.push_back(how == Refit::from_start);
    if (std::find(anew.begin(), anew.end(), 1) == anew.end()) break;
    if (std::find(afresh.begin(), afresh.end(), 1) != afresh.end()) newton_.begin(afresh);
    newton_.solve(info, report, stop, anew);
  }
  std::vector<std::string> why(model_.envs);
  for (const auto& effect : effects_) effect->object(newton_.q().view(), why);
  for (Index e = 0; e < model_.envs; ++e)
    if (!why[e].empty()) throw Failure{why[e], e};
}

void Simulation::accept() {
  model_.q.copy_from(newton_.q());
  std::vector<double> lost;
  for (Index e = 0; e < model_.envs; ++e) {
    const StepEnergy& energy = newton_.energies().of_step(e);
    support_work_ += energy.work;
    lost.push_back(options_.is_static ? INFINITY : std::max(-energy.gain, 0.0));
  }
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    const Timed timed(clock_, effects_[k]->name(), "end_step");
    effects_[k]->end_step(model_.q.view(), *newton_.at().of[k]);
  }
  for (std::size_t k = 0; k < effects_.size(); ++k) effects_[k]->adapt(lost, *newton_.at().of[k]);
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

  // The step is cut into 2^halvings units, so that substeps always meet its end exactly.
  const long units = 1L << options_.halvings;
  long done = 0, size = units;
  std::optional<MemoryArchive> before;  // set once a substep was accepted
  const auto undo = [&] {
    if (!before) return;
    before->rewind();
    checkpoint(*before);
  };
  std::vector<EnergyGuard> guards(model_.envs);
  const double gain = newton_.potential().symmetric() ? tuning::kGainShare : tuning::kFrozenGainShare;
  const auto stop = [&] {
    if (stop_asked && stop_asked()) throw Stopped{};
  };

  while (done < units) {
    const effects::StepInfo info{time_ + options_.dt * (static_cast<double>(done) / units), options_.dt * (static_cast<double>(size) / units), step_, options_.is_static};
    try {
      for (const auto& effect : effects_) {
        const Timed timed(clock_, effect->name(), "begin_step");
        effect->begin_step(info);
      }
      solve(info, report, stop);
      bool halve = false;
      for (Index e = 0; size > 1 && e < model_.envs; ++e) halve |= guards[e].wants_halving(newton_.energies().of_step(e), gain);
      if (halve) {
        size /= 2;
        continue;
      }
    } catch (const Stopped&) {
      undo();
      throw;
    } catch (const Failure& failure) {
      if (size > 1) {
        size /= 2;
        continue;
      }
      undo();
      std::ostringstream message;
      message << "step " << step_ << " (t = " << info.t0 << " s, dt = " << info.dt << " s) failed: " << failure.reason;
      if (options_.is_static) message << unsupported(model_);
      throw Error(Exit::solve, message.str());
    }
    if (size < units && !before) {
      before.emplace();
      checkpoint(*before);
    }
    accept();
    for (EnergyGuard& guard : guards) guard.accepted();
    ++report.substeps;
    done += size;
    if (size < units && done % (2 * size) == 0) size *= 2;
  }

  ++step_;
  time_ = options_.dt * step_;
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
    const std::vector<Vec3> sum = resultants(newton_.at().gradients[k].download());
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
  std::vector<Vec3> load(model_.bodies.size(), Vec3::Zero());  // of all effects
  double largest = 0;                                          // of one effect on one body
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    const std::vector<Vec3> sums = resultants(newton_.at().gradients[k].download());
    const Vec3 f = -resultant(sums);
    put(std::string(effects_[k]->name()), f);
    total += f;
    for (std::size_t i = 0; i < load.size(); ++i) {
      load[i] -= sums[i];
      largest = std::max(largest, sums[i].norm());
    }
  }
  sink.scalar("balance", "largest", "N", largest);

  // The support's force on a held block is what the effects leave over there, in the held directions.
  const std::vector<Vec3> g = newton_.at().gradient.download();
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
      if (!model_.held[b]) continue;
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
    if (q.size() != 3 * static_cast<std::size_t>(model_.blocks)) throw Error(Exit::file, "the checkpoint belongs to another scene: it has " + std::to_string(q.size() / 3) + " blocks, the scene " + std::to_string(model_.blocks));
    model_.q.upload(unflatten(q));
    solved_ = false;
  }
  for (const auto& effect : effects_) {
    PrefixedArchive part(archive, std::string(effect->name()));
    effect->checkpoint(part);
  }
}

}  // namespace mortise::solver
