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

void Arcs::bend(device::View<const Vec3> q, const device::Buffer<Vec3>& dq, const EnvMask& whose, std::vector<double>& alpha, Linearised& at) {
  const model::Model& model = system_.model;
  EnvMask now(model.envs, 0), kept(model.envs, 0);
  std::vector<double> less(model.envs, 0.0), share(model.envs, 1.0);
  for (Index e = 0; e < model.envs; ++e) {
    now[e] = whose[e] && alpha[e] > 0;
    kept[e] = bent(e) && !now[e];
    less[e] = alpha[e] - 1;
  }
  if (!any(now)) return;
  device::Buffer<Vec3> way, arc;
  way.copy_from(dq);
  add_scaled(dq.view(), less, model.block_env.view(), way);
  arc.copy_from(way);
  for (const auto& effect : system_.potential.effects()) effect->bend(q, arc.view());
  if (model.ties.any()) model.ties.carry(arc.view());
  copy_envs(arc, now, model.env_blocks, way);
  if (any(kept)) copy_envs(way_, kept, model.env_blocks, way);
  way_.swap(way);
  device::Fetch fetch;
  system_.potential.max_step(std::as_const(way_).view(), at, {share, fetch});
  fetch.now("arc");
  for (Index e = 0; e < model.envs; ++e) {
    if (now[e]) alpha[e] *= share[e];
    if (kept[e]) share[e] = share_[e], now[e] = 1;
  }
  bent_ = std::move(now), share_ = std::move(share);
}

void Arcs::advance(device::View<const Vec3> q, const device::Buffer<Vec3>& dq, const std::vector<double>& alpha, device::Buffer<Vec3>& trial) const {
  const model::Model& model = system_.model;
  if (!any(bent_)) return solver::advance(q, dq.view(), alpha, model, trial);
  device::Buffer<Vec3> way;
  way.copy_from(dq);
  copy_envs(way_, bent_, model.env_blocks, way);
  std::vector<double> along = alpha;
  for (Index e = 0; e < model.envs; ++e)
    if (bent_[e] && alpha[e] > 0) along[e] = share_[e];
  solver::advance(q, std::as_const(way).view(), along, model, trial);
}

}  // namespace mortise::solver
