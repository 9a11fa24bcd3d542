#include "solver/arcs.h"

#include <utility>

#include "solver/kernels.h"
#include "solver/tuning.h"

namespace mortise::solver {

void Arcs::ask(device::View<const Vec3> q, const device::Buffer<Vec3>& dq, device::Fetch& fetch) {
  bent_.clear();
  turning_.assign(system_.model.envs, 0.0);
  for (const auto& effect : system_.potential.effects()) effect->turning(q, dq.view(), {turning_, fetch});
}

// What meets something on the way to the end of its arc may go farther along the arc than so much of that straight way: it goes so much of the arc.
void Arcs::begin(device::View<const Vec3> q, const device::Buffer<Vec3>& dq, const EnvMask& whose, std::vector<double>& alpha, Linearised& at) {
  EnvMask turn(whose), cut(whose.size(), 0);
  for (std::size_t e = 0; e < whose.size(); ++e)
    if (turn[e] = whose[e] && turning_[e] > tuning::kArc && turning_[e] < tuning::kLongestArc; turn[e]) alpha[e] = 1;
  bend(q, dq, turn, alpha, at);
  for (std::size_t e = 0; e < whose.size(); ++e) cut[e] = turn[e] && alpha[e] < 1;
  bend(q, dq, cut, alpha, at);
}

void Arcs::bend_again(device::View<const Vec3> q, const device::Buffer<Vec3>& dq, const EnvMask& whose, std::vector<double>& alpha, Linearised& at) {
  EnvMask turn(whose);
  for (std::size_t e = 0; e < whose.size(); ++e) turn[e] = whose[e] && !bent_.empty() && bent_[e] && alpha[e] > 0;
  if (!any(turn)) return;
  bend(q, dq, turn, alpha, at);
  system_.potential.reach(at);
}

// The ways alpha dq of the environments of `whose`; alpha falls to how far they lead then. Others that are bent stay so.
void Arcs::bend(device::View<const Vec3> q, const device::Buffer<Vec3>& dq, const EnvMask& whose, std::vector<double>& alpha, Linearised& at) {
  if (!any(whose)) return;
  const model::Model& model = system_.model;
  std::vector<double> less(model.envs, 0.0), more(model.envs, 0.0), share(model.envs, 1.0);
  EnvMask kept(model.envs, 0);
  bent_.resize(model.envs, 0);
  for (Index e = 0; e < model.envs; ++e) {
    kept[e] = bent_[e] && !whose[e];
    if (whose[e]) less[e] = alpha[e] - 1, more[e] = 1 / alpha[e] - 1;
  }
  device::Buffer<Vec3> arc;
  arc.copy_from(dq);
  add_scaled(dq.view(), less, model.block_env.view(), arc);
  for (const auto& effect : system_.potential.effects()) effect->bend(q, arc.view());
  if (model.ties.any()) model.ties.carry(arc.view());
  device::Fetch fetch;
  system_.potential.max_step(std::as_const(arc).view(), at, {share, fetch});
  fetch.now("arc");
  device::Buffer<Vec3> unit;
  unit.copy_from(arc);
  add_scaled(std::as_const(arc).view(), more, model.block_env.view(), unit);
  if (any(kept)) copy_envs(way_, kept, model.env_blocks, unit);
  way_.swap(unit);
  for (Index e = 0; e < model.envs; ++e) {
    if (whose[e]) alpha[e] *= share[e];
    bent_[e] |= whose[e];
  }
}

void Arcs::advance(device::View<const Vec3> q, const device::Buffer<Vec3>& dq, const std::vector<double>& alpha, device::Buffer<Vec3>& trial) const {
  const model::Model& model = system_.model;
  if (!any(bent_)) return solver::advance(q, dq.view(), alpha, model, trial);
  device::Buffer<Vec3> way;
  way.copy_from(dq);
  copy_envs(way_, bent_, model.env_blocks, way);
  solver::advance(q, std::as_const(way).view(), alpha, model, trial);
}

}  // namespace mortise::solver
