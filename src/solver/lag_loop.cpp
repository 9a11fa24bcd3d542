#include "solver/lag_loop.h"

#include <algorithm>
#include <cmath>

#include "solver/kernels.h"

namespace mortise::solver {

LagLoop::LagLoop(System& system, double settled, bool lags)
    : system_(system), lags_(lags), wanted_(lags ? settled : system.options.relative_tolerance) {}

double LagLoop::finest() const { return std::max(system_.options.relative_tolerance, tuning::kLagFinest * wanted_); }

void LagLoop::begin_solve(const device::Buffer<Vec3>& q) {
  q_.copy_from(q);
  round_ = 0;
  relaxation_.assign(system_.model.envs, 1.0);
  nearest_.assign(system_.model.envs, INFINITY), idle_.assign(system_.model.envs, 0);
  relative_.assign(system_.model.envs, lags_ ? tuning::kLagCoarsest * wanted_ : wanted_);
}

void LagLoop::refreshed(Index env, double relative_residual) {
  idle_[env] = relative_residual < nearest_[env] ? 0 : idle_[env] + 1;
  nearest_[env] = std::min(nearest_[env], relative_residual);
  relative_[env] = std::clamp(tuning::kLagShare * relative_residual, tuning::kLagFinest * wanted_, tuning::kLagCoarsest * wanted_);
}

void LagLoop::restart(Index env, const device::Buffer<Vec3>& q) {
  copy_blocks(q, system_.model.env_blocks[env], system_.model.env_blocks[env + 1], q_);
}

void LagLoop::relax(const device::Buffer<Vec3>& q, const EnvMask& whose, Linearised& near, Linearised& at) {
  const model::Model& model = system_.model;
  subtract(q.view(), std::as_const(q_).view(), move_);
  if (round_++ > 0) {
    device::Buffer<Vec3> change;
    subtract(std::as_const(move_).view(), std::as_const(last_).view(), change);
    std::vector<double> along(model.envs, 0.0), square(model.envs, 0.0);
    device::Fetch fetch;
    dot(std::as_const(last_).view(), std::as_const(change).view(), model.env_blocks, {along, fetch});
    dot(std::as_const(change).view(), std::as_const(change).view(), model.env_blocks, {square, fetch});
    fetch.now("relaxation");
    for (Index e = 0; e < model.envs; ++e)
      if (square[e] > 0) relaxation_[e] = std::clamp(-relaxation_[e] * along[e] / square[e], tuning::kLeastRelaxation, 1.0);
  }
  last_.copy_from(move_);
  bool any = false;
  for (Index e = 0; e < model.envs; ++e) {
    if (whose[e] && relaxation_[e] < 1) {
      any = true;
      continue;
    }
    restart(e, q);
    clear_blocks(move_, model.env_blocks[e], model.env_blocks[e + 1]);
  }
  if (!any) return;
  const effects::Want frozen = effects::Want::frozen();
  std::vector<double> relative_residual = relaxation_;
  system_.potential.linearise(std::as_const(q_).view(), frozen, near);
  device::Fetch fetch;
  system_.potential.max_step(std::as_const(move_).view(), near, {relative_residual, fetch});
  fetch.now("relaxation");
  add_scaled(std::as_const(move_).view(), relative_residual, std::as_const(model.block_env).view(), q_);
  system_.potential.linearise(std::as_const(q_).view(), frozen, near);
  system_.potential.sample(near);
  system_.potential.lag(near, at);
}

}  // namespace mortise::solver
