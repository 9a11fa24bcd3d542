#include "solver/simulation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <sstream>

#include "base/memory_archive.h"
#include "base/pass_on.h"
#include "solver/timed.h"
#include "solver/unsupported.h"

namespace mortise::solver {
namespace {

// A step that makes energy from nowhere is tried again with half its length, as long as the gain falls to about a quarter, as that of
// backward Euler does; after one try in vain no more of this step. What frozen samples (mortar_contact) and lagged friction feed into motions does
// not fall so, and some of it is let pass.
class EnergyGuard {
 public:
  bool wants_halving(const Newton& newton) {
    constexpr double kShare = 1e-6, kFrozenShare = 1e-3;  // of the energy there is
    const double gain = newton.energy_gain();
    if (!helps_ || !(gain > (newton.conservative() ? kShare : kFrozenShare) * newton.energy_there())) return false;
    helps_ = !(gain > last_ / 3);
    last_ = gain;
    return helps_;
  }
  void accepted() { last_ = INFINITY; }

 private:
  double last_ = INFINITY;  // of the step of twice the length [J]
  bool helps_ = true;
};

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
  constexpr int kMostFits = 8;  // a pressure that hangs on the stiffness is met within three or four
  newton_.solve(info, report, stop);
  for (int fits = 0; fits < kMostFits; ++fits) {
    using Refit = effects::Effect::Refit;
    Refit most = Refit::none;
    for (const auto& effect : effects_) most = std::max(most, effect->refit(newton_.q().view()));
    if (most == Refit::none) break;
    newton_.solve(info, report, stop, most == Refit::from_here);
  }
  for (const auto& effect : effects_)
    if (const std::string why = effect->objection(newton_.q().view()); !why.empty()) throw Failure{why};
}

void Simulation::accept() {
  model_.q.copy_from(newton_.q());
  for (const auto& effect : effects_) {
    const Timed timed(clock_, effect->name(), "end_step");
    effect->end_step(model_.q.view());
  }
  support_work_ += newton_.support_work();
  const double lost = options_.is_static ? INFINITY : std::max(-newton_.energy_gain(), 0.0);
  for (const auto& effect : effects_) effect->adapt(lost);
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
  EnergyGuard guard;
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
      if (size > 1 && guard.wants_halving(newton_)) {
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
    guard.accepted();
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
  if (!solved_)
    for (const auto& effect : effects_) effect->assemble(model_.q.view(), false);
  double unlike = 0;
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    const Timed timed(clock_, effects_[k]->name(), "report");
    WrittenForces written(sink, model_);
    effects_[k]->report(written);
    if (!solved_ || !written.any()) continue;
    const std::vector<Vec3> sum = resultants(newton_.effect_gradients()[k].download());
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
    const std::vector<Vec3> sums = resultants(newton_.effect_gradients()[k].download());
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
  const std::vector<Vec3> g = newton_.gradient().download();
  const std::vector<Mat3> P = model_.projector.download();
  std::vector<Vec3> reaction(g.size());
  for (std::size_t b = 0; b < g.size(); ++b) reaction[b] = g[b] - P[b] * g[b];
  const std::vector<Vec3> supports = resultants(reaction);
  const Vec3 support = resultant(supports);
  put("support", support);
  put("defect", total + support);

  if (newton_.measures_energy()) sink.scalar("supports", "work", "J", support_work_);
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
