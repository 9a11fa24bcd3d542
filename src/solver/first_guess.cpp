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
  free_way(std::as_const(q).view(), carried, model.projector.view(), way_);
  if (model.ties.any()) model.ties.carry(way_.view());
  EnvMask left = whose;
  if (largest_of(moves) > 0) {
    system_.supports(std::as_const(q).view(), supports_);
    device::Buffer<Vec3> with;
    with.copy_from(way_);
    add(std::as_const(supports_).view(), with);
    EnvMask moved = whose;
    for (Index e = 0; e < model.envs; ++e) moved[e] = whose[e] && moves[e] > 0;
    const EnvMask taken = any(moved) ? go(moved, with, &supports_, q, at) : moved;
    for (Index e = 0; e < model.envs; ++e) left[e] = whose[e] && !taken[e];
  }
  if (model.ties.driven()) model.ties.add_offset(std::as_const(q).view(), way_.view());
  if (any(left)) go(left, way_, nullptr, q, at);
}

EnvMask FirstGuess::go(const EnvMask& whose, const device::Buffer<Vec3>& way, const device::Buffer<Vec3>* supports, device::Buffer<Vec3>& q,
                       Linearised& at) {
  const model::Model& model = system_.model;
  const model::Only only(model, whose);
  std::vector<double> alpha(model.envs, 1.0);
  device::Fetch fetch;
  system_.potential.max_step(way.view(), at, {alpha, fetch});
  energies_.find(std::as_const(q).view(), at, fetch);
  fetch.now();
  for (Index e = 0; e < model.envs; ++e) alpha[e] = whose[e] && alpha[e] >= 1 ? 1 : 0;
  const std::vector<double> before = supports ? energies_behind(q, *supports, alpha, at) : energies_.sum(energies_.known());
  const std::vector<double> after = energies_behind(q, way, alpha, at);
  EnvMask taken(model.envs, 0);
  for (Index e = 0; e < model.envs; ++e) taken[e] = alpha[e] == 1 && std::isfinite(after[e]) && !(after[e] >= before[e]);
  energies_.begin_search(taken);
  for (Index e = 0; e < model.envs; ++e)
    if (taken[e]) copy_blocks(trial_, model.env_blocks[e], model.env_blocks[e + 1], q), energies_.forget(e);
  return taken;
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
