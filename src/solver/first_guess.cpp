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
  support_move(std::as_const(q).view(), model.target.view(), model.projector.view(), supports_);
  const std::vector<double> moves = largest(std::as_const(supports_).view(), model.env_blocks);
  system_.supports(std::as_const(q).view(), supports_);
  free_way(std::as_const(q).view(), carried, model.projector.view(), way_);
  if (model.ties.any()) model.ties.carry(way_.view());
  add(std::as_const(supports_).view(), way_);

  std::vector<double> alpha(model.envs, 1.0);
  device::Fetch fetch;
  system_.potential.max_step(std::as_const(way_).view(), at, {alpha, fetch});
  energies_.find(std::as_const(q).view(), at, fetch);
  fetch.now();
  for (Index e = 0; e < model.envs; ++e) alpha[e] = whose[e] && alpha[e] >= 1 ? 1 : 0;
  std::vector<double> before = energies_.sum(energies_.known());
  if (largest_of(moves) > 0) {
    const std::vector<double> there = energies_behind(q, supports_, alpha, at);
    for (Index e = 0; e < model.envs; ++e)
      if (moves[e] > 0) before[e] = std::isnan(there[e]) ? INFINITY : there[e];
  }
  const std::vector<double> after = energies_behind(q, way_, alpha, at);
  EnvMask taken(model.envs, 0);
  for (Index e = 0; e < model.envs; ++e) taken[e] = alpha[e] == 1 && std::isfinite(after[e]) && after[e] < before[e];
  energies_.begin_search(taken);
  for (Index e = 0; e < model.envs; ++e)
    if (taken[e]) copy_blocks(trial_, model.env_blocks[e], model.env_blocks[e + 1], q), energies_.forget(e);
}

std::vector<double> FirstGuess::energies_behind(const device::Buffer<Vec3>& q, const device::Buffer<Vec3>& way, const std::vector<double>& alpha,
                                                const Linearised& at) {
  advance(q.view(), way.view(), alpha, system_.model, trial_);
  Energies there;
  device::Fetch fetch;
  system_.potential.energies(std::as_const(trial_).view(), at, there, fetch);
  fetch.now();
  return energies_.sum(there);
}

}  // namespace mortise::solver
