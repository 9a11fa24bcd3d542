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

EnvMask FirstGuess::find(const EnvMask& whose, device::Buffer<Vec3>& q, Linearised& at) {
  const model::Model& model = system_.model;
  landed_ = false;
  device::View<const Vec3> carried;
  for (const auto& effect : system_.potential.effects())
    if (const auto to = effect->carried(); to.n > 0) carried = to;
  if (carried.n == 0 || !any(whose)) return EnvMask(model.envs, 0);
  free_way(std::as_const(q).view(), carried, model.projector.view(), way_);
  if (model.ties.any()) model.ties.carry(way_.view());

  EnvMask left = whose, taken(model.envs, 0);
  system_.supports(std::as_const(q).view(), supports_);
  const std::vector<double> moves = largest(std::as_const(supports_).view(), model.env_blocks);
  EnvMask driven = whose;
  for (Index e = 0; e < model.envs; ++e) driven[e] = whose[e] && moves[e] > 0;
  if (any(driven)) {
    with_supports_.copy_from(way_);
    add(std::as_const(supports_).view(), with_supports_);
    taken = go(driven, with_supports_, std::as_const(supports_).view(), q, at);
    for (Index e = 0; e < model.envs; ++e) left[e] = whose[e] && !taken[e];
  }
  if (!any(left)) return taken;
  if (model.ties.driven()) model.ties.add_offset(std::as_const(q).view(), way_.view());
  const EnvMask without = go(left, way_, {}, q, at);
  for (Index e = 0; e < model.envs; ++e) taken[e] |= without[e];
  return taken;
}

EnvMask FirstGuess::go(const EnvMask& whose, const device::Buffer<Vec3>& way, device::View<const Vec3> supports, device::Buffer<Vec3>& q,
                       Linearised& at) {
  const model::Model& model = system_.model;
  const model::Only only(model, whose);
  std::vector<double> alpha(model.envs, 1.0);
  device::Fetch fetch;
  system_.potential.max_step(way.view(), at, {alpha, fetch});
  energies_.find(std::as_const(q).view(), at, fetch);
  fetch.now("first guess");
  for (Index e = 0; e < model.envs; ++e) alpha[e] = whose[e] && alpha[e] >= 1 ? 1 : 0;
  std::vector<double> before = energies_.sum(energies_.known());
  if (supports.n > 0) {
    advance(std::as_const(q).view(), supports, alpha, model, trial_);
    before = energies_there(at, false);
    advance(std::as_const(q).view(), way.view(), alpha, model, trial_);
  } else {  // not `advance`, by which supports would land on their targets
    trial_.copy_from(q);
    add_scaled(way.view(), alpha, model.block_env.view(), trial_);
    if (model.ties.any()) model.ties.place(trial_.view());
  }
  const std::vector<double> after = energies_there(at, lands_);
  EnvMask taken(model.envs, 0);
  for (Index e = 0; e < model.envs; ++e) taken[e] = alpha[e] == 1 && std::isfinite(after[e]) && !(after[e] >= before[e]);
  landed_ = lands_ && taken == whose;
  lands_ = any(taken);
  energies_.begin_search(taken);
  for (Index e = 0; e < model.envs; ++e)
    if (taken[e]) copy_blocks(trial_, model.env_blocks[e], model.env_blocks[e + 1], q), energies_.forget(e);
  return taken;
}

std::vector<double> FirstGuess::energies_there(Linearised& at, bool next) {
  Energies there;
  device::Fetch fetch;
  system_.potential.energies(std::as_const(trial_).view(), at, there, fetch);
  if (next) system_.potential.foresee(std::as_const(trial_).view(), at, fetch);
  fetch.now("first guess energies");
  return energies_.sum(there);
}

}  // namespace mortise::solver
