#include "solver/first_guess.h"

#include <cmath>
#include <utility>

#include "solver/kernels.h"

namespace mortise::solver {
namespace {

// P (to - from)
void free_way(device::View<const Vec3> from, device::View<const Vec3> to, device::View<const Mat3> projector, device::Buffer<Vec3>& way) {
  way.resize(from.n);
  const device::View<Vec3> out = way.view();
  device::parallel_for("solver.free_way", from.n, [=] MORTISE_HD(Index b) { out[b] = projector[b] * (to[b] - from[b]); });
}

}  // namespace

void FirstGuess::find(const EnvMask& whose, device::Buffer<Vec3>& q, Linearised& at) {
  const model::Model& model = system_.model;
  device::View<const Vec3> carried;
  for (const auto& effect : system_.potential.effects())
    if (const auto to = effect->carried(); to.n > 0) carried = to;
  if (carried.n == 0 || !any(whose)) return;
  free_way(std::as_const(q).view(), carried, model.projector.view(), way_);
  if (model.ties.any()) model.ties.carry(way_.view());
  if (model.ties.driven()) model.ties.add_offset(std::as_const(q).view(), way_.view());

  std::vector<double> alpha(model.envs, 1.0);
  device::Fetch fetch;
  system_.potential.max_step(std::as_const(way_).view(), at, {alpha, fetch});
  energies_.find(std::as_const(q).view(), at, fetch);
  fetch.now();
  for (Index e = 0; e < model.envs; ++e) alpha[e] = whose[e] && alpha[e] >= 1 ? 1 : 0;
  const std::vector<double> before = energies_.sum(energies_.known());
  trial_.copy_from(q);
  add_scaled(std::as_const(way_).view(), alpha, model.block_env.view(), trial_);
  if (model.ties.any()) model.ties.place(trial_.view());
  Energies there;
  system_.potential.energies(std::as_const(trial_).view(), at, there, fetch);
  fetch.now();
  const std::vector<double> after = energies_.sum(there);
  EnvMask taken(model.envs, 0);
  for (Index e = 0; e < model.envs; ++e) taken[e] = alpha[e] == 1 && std::isfinite(after[e]) && after[e] < before[e];
  energies_.begin_search(taken);
  for (Index e = 0; e < model.envs; ++e)
    if (taken[e]) copy_blocks(trial_, model.env_blocks[e], model.env_blocks[e + 1], q), energies_.forget(e);
}

}  // namespace mortise::solver
