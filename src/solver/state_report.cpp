// What a simulation reports of the accepted state, to every environment's sink what it would be told alone.
#include <algorithm>
#include <memory>
#include <optional>

#include "base/pass_on.h"
#include "effects/per_environment.h"
#include "solver/flatten.h"
#include "solver/simulation.h"
#include "solver/tie_forces.h"
#include "solver/timed.h"

namespace mortise::solver {
namespace {

// Hands on what an effect reports of an environment, and sums its forces on points by body.
class WrittenForces : public PassOn {
 public:
  WrittenForces(FieldSink& next, const model::Model& model, Index env)
      : PassOn(&next), model_(model), env_(env), sum_(model.env_bodies[env + 1] - model.env_bodies[env], Vec3::Zero()) {}
  void points(std::string_view name, std::string_view unit, int components, std::span<const double> values) override {
    PassOn::points(name, unit, components, values);
    if (unit != "N" || components != 3) return;
    any_ = true;
    for (std::size_t i = 0; i < sum_.size(); ++i) {
      const model::Body& body = model_.bodies[model_.env_bodies[env_] + i];
      for (Index p = body.point_begin; p < body.point_end; ++p)
        for (int c = 0; c < 3; ++c) sum_[i][c] += values[3 * static_cast<std::size_t>(p - model_.env_points[env_]) + c];
    }
  }
  bool any() const { return any_; }
  const std::vector<Vec3>& sum() const { return sum_; }

 private:
  const model::Model& model_;
  Index env_;
  std::vector<Vec3> sum_;
  bool any_ = false;
};

}  // namespace

void Simulation::report(const FieldSinks& sinks) {
  device::Buffer<Vec3> y;
  model_.points_of(model_.q.view(), y);
  std::vector<Vec3> u = y.download();
  const std::vector<Vec3> rest = model_.rest_points.download();
  for (std::size_t i = 0; i < u.size(); ++i) u[i] -= rest[i];
  effects::report_points(sinks, model_, "displacement", "m", 3, flatten(u));
  // Before the first step, and after a restart, nothing has been evaluated at a state yet.
  EnvMask begun(model_.envs, 0);
  std::vector<FieldSink*> solved(model_.envs, nullptr), others(model_.envs, nullptr);
  for (Index e = 0; e < model_.envs; ++e) {
    begun[e] = sinks.wanted(e) && !solved_[e];
    if (sinks.wanted(e)) (solved_[e] ? solved : others)[e] = &sinks[e];
  }
  if (std::any_of(solved.begin(), solved.end(), [](const FieldSink* s) { return s; })) {
    report_balance(FieldSinks(solved));
    report_effects(FieldSinks(solved), true);
  }
  if (!any(begun)) return;
  newton_.begin(begun);  // which leaves the states of the others
  report_effects(FieldSinks(others), false);
}

// What effects say of the states that Newton's linearisation is of; where those are solved, also how the forces that are written differ from those
// that the solver balanced.
void Simulation::report_effects(const FieldSinks& sinks, bool solved) {
  std::vector<double> unlike(model_.envs, 0.0);
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    const Timed timed(clock_, effects_[k]->name(), "report");
    std::vector<std::unique_ptr<WrittenForces>> written(model_.envs);
    std::vector<FieldSink*> through(model_.envs, nullptr);
    for (Index e = 0; e < model_.envs; ++e)
      if (sinks.wanted(e)) written[e] = std::make_unique<WrittenForces>(sinks[e], model_, e), through[e] = written[e].get();
    effects_[k]->report(FieldSinks(through), *newton_.at().of[k]);
    if (!solved) continue;
    const std::vector<Vec3> sum = resultants(forces_.of(k, newton_.at()).download());
    for (Index e = 0; e < model_.envs; ++e) {
      if (!sinks.wanted(e) || !written[e]->any()) continue;
      for (std::size_t i = 0; i < written[e]->sum().size(); ++i)
        unlike[e] = std::max(unlike[e], (written[e]->sum()[i] + sum[model_.env_bodies[e] + i]).norm());
    }
  }
  if (solved) sinks.scalar("balance", "written_defect", "N", unlike);
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
void Simulation::report_balance(const FieldSinks& sinks) {
  const auto resultant = [this](const std::vector<Vec3>& sums, Index e) {
    Vec3 sum = Vec3::Zero();
    for (Index i = model_.env_bodies[e]; i < model_.env_bodies[e + 1]; ++i) sum += sums[i];
    return sum;
  };
  const auto put = [&](Index e, const std::string& name, const Vec3& f) {
    for (int k = 0; k < 3; ++k) sinks[e].scalar("balance", name + "_" + "xyz"[k], "N", f[k]);
  };

  std::vector<Vec3> total(model_.envs, Vec3::Zero());
  std::vector<Vec3> load(model_.bodies.size(), Vec3::Zero());  // of all effects and ties
  std::vector<double> largest(model_.envs, 0.0);               // of one effect on one body
  std::optional<TieForces> ties;
  if (model_.ties.any()) {
    std::vector<Vec3> all(model_.blocks, Vec3::Zero());
    for (std::size_t k = 0; k < effects_.size(); ++k) {
      const std::vector<Vec3> g = forces_.of(k, newton_.at()).download();
      for (std::size_t b = 0; b < all.size(); ++b) all[b] += g[b];
    }
    ties.emplace(model_, model_.q.download(), std::move(all));
    load = ties->on_bodies();
    ties->report(sinks);
  }
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    const std::vector<Vec3> sums = resultants(forces_.of(k, newton_.at()).download());
    for (Index e = 0; e < model_.envs; ++e) {
      Vec3 f = -resultant(sums, e);
      if (effects_[k]->kind().role == effects::Role::tie) f += ties->of_effect(effects_[k]->name(), e);
      put(e, std::string(effects_[k]->name()), f);
      total[e] += f;
    }
    for (std::size_t i = 0; i < load.size(); ++i) {
      load[i] -= sums[i];
      double& most = largest[model_.bodies[i].env];
      most = std::max(most, sums[i].norm());
    }
  }
  sinks.scalar("balance", "largest", "N", largest);

  // The support's force on a held block is what the effects leave over there, in the held directions.
  std::vector<Vec3> g = forces_.sum(newton_.at()).download();
  if (ties && !ties->handed_on().empty())
    for (std::size_t b = 0; b < g.size(); ++b) g[b] += ties->handed_on()[b];
  const auto carried = [&](Index b) { return ties && ties->carried(b); };
  const std::vector<Mat3> P = model_.projector.download();
  std::vector<Vec3> reaction(g.size(), Vec3::Zero());
  for (std::size_t b = 0; b < g.size(); ++b)
    if (!carried(static_cast<Index>(b))) reaction[b] = g[b] - P[b] * g[b];
  const std::vector<Vec3> supports = resultants(reaction);
  for (Index e = 0; e < model_.envs; ++e) {
    const Vec3 support = resultant(supports, e);
    put(e, "support", support);
    put(e, "defect", total[e] + support);
  }

  if (newton_.energies().measures()) {
    sinks.scalar("supports", "work", "J", support_work_);
    sinks.scalar("supports", "work_lag", "J", work_lag_);
  }
  std::vector<FieldSink*> held_some(model_.envs, nullptr);
  std::vector<double> field(3 * static_cast<std::size_t>(model_.points), 0.0);
  for (const model::Body& body : model_.bodies) {
    const Vec3& sum = supports[&body - model_.bodies.data()];
    FieldSink& sink = sinks[body.env];
    bool held = false;
    for (Index b = body.block_begin; b < body.block_end; ++b) {
      if (!model_.held[b] || model_.held[b] == model::Model::kTied || carried(b)) continue;
      held = true;
      if (body.type != model::BodyType::soft) continue;
      const std::size_t point = body.point_begin + (b - body.block_begin);
      for (int k = 0; k < 3; ++k) field[3 * point + k] = reaction[b][k];
    }
    if (!held) continue;
    if (sinks.wanted(body.env)) held_some[body.env] = &sink;
    for (int k = 0; k < 3; ++k) sink.scalar("supports", body.name + "_" + "xyz"[k], "N", sum[k]);
    sink.scalar("supports", body.name + "_defect", "N", (sum + load[&body - model_.bodies.data()]).norm());  // what they do not bear
  }
  effects::report_points(FieldSinks(held_some), model_, "support_force", "N", 3, field);
}

}  // namespace mortise::solver
