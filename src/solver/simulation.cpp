#include "solver/simulation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <sstream>

#include "base/memory_archive.h"
#include "solver/timed.h"

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
      newton_.solve(info, report, stop);
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
  for (const auto& effect : effects_) {
    const Timed timed(clock_, effect->name(), "report");
    effect->report(sink);
  }
}

// Newton's first law of the accepted state: over all blocks that carry translation (nodes, and the position block of stiff
// bodies) the forces of all effects and of the supports sum to zero.
void Simulation::report_balance(FieldSink& sink) {
  std::vector<std::uint8_t> carries(model_.blocks, 1);
  for (const model::Body& body : model_.bodies)
    if (body.type == model::BodyType::stiff)
      for (Index k = 1; k < 4; ++k) carries[body.block_begin + k] = 0;
  const auto resultant = [&](const std::vector<Vec3>& g) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t b = 0; b < g.size(); ++b)
      if (carries[b]) sum += g[b];
    return sum;
  };
  const auto put = [&](const std::string& name, const Vec3& f) {
    for (int k = 0; k < 3; ++k) sink.scalar("balance", name + "_" + "xyz"[k], "N", f[k]);
  };

  Vec3 total = Vec3::Zero();
  std::vector<Vec3> load(model_.bodies.size(), Vec3::Zero());  // of all effects
  double largest = 0;                                          // of one effect on one body
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    const std::vector<Vec3> gradient = newton_.effect_gradients()[k].download();
    const Vec3 f = -resultant(gradient);
    put(std::string(effects_[k]->name()), f);
    total += f;
    for (std::size_t i = 0; i < load.size(); ++i) {
      Vec3 sum = Vec3::Zero();
      for (Index b = model_.bodies[i].block_begin; b < model_.bodies[i].block_end; ++b)
        if (carries[b]) sum -= gradient[b];
      load[i] += sum;
      largest = std::max(largest, sum.norm());
    }
  }
  sink.scalar("balance", "largest", "N", largest);

  // The support's force on a held block is what the effects leave over there, in the held directions.
  const std::vector<Vec3> g = newton_.gradient().download();
  const std::vector<Mat3> P = model_.projector.download();
  std::vector<Vec3> reaction(g.size());
  for (std::size_t b = 0; b < g.size(); ++b) reaction[b] = g[b] - P[b] * g[b];
  const Vec3 support = resultant(reaction);
  put("support", support);
  put("defect", total + support);

  if (newton_.measures_energy()) sink.scalar("supports", "work", "J", support_work_);
  bool any = false;
  std::vector<double> field(3 * static_cast<std::size_t>(model_.points), 0.0);
  for (const model::Body& body : model_.bodies) {
    Vec3 sum = Vec3::Zero();
    bool held = false;
    for (Index b = body.block_begin; b < body.block_end; ++b) {
      if (!model_.held[b]) continue;
      held = any = true;
      if (carries[b]) sum += reaction[b];
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
