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
  // Where supports are expected to stay, how far the way leads comes with whether they do.
  std::vector<double> moves(model.envs, 0.0), free;
  device::Fetch fetch;
  largest(std::as_const(supports_).view(), model.env_blocks, {moves, fetch});
  if (!driven_) {
    const model::Only only(model, whose);
    free.assign(model.envs, 1.0);
    system_.potential.max_step(std::as_const(way_).view(), at, {free, fetch});
  }
  fetch.now("first guess");
  EnvMask driven = whose;
  for (Index e = 0; e < model.envs; ++e) driven[e] = whose[e] && moves[e] > 0;
  driven_ = any(driven);
  if (driven_) {
    free.clear();
    with_supports_.copy_from(way_);
    add(std::as_const(supports_).view(), with_supports_);
    taken = go(driven, with_supports_, std::as_const(supports_).view(), {}, q, at);
    for (Index e = 0; e < model.envs; ++e) left[e] = whose[e] && !taken[e];
  }
  if (!any(left)) return taken;
  if (model.ties.driven()) model.ties.add_offset(std::as_const(q).view(), way_.view());
  const EnvMask without = go(left, way_, {}, std::move(free), q, at);
  for (Index e = 0; e < model.envs; ++e) taken[e] |= without[e];
  return taken;
}

EnvMask FirstGuess::go(const EnvMask& whose, const device::Buffer<Vec3>& way, device::View<const Vec3> supports, std::vector<double> free,
                       device::Buffer<Vec3>& q, Linearised& at) {
  const model::Model& model = system_.model;
  const model::Only only(model, whose);
  device::Fetch fetch;
  if (free.empty()) {
    free.assign(model.envs, 1.0);
    system_.potential.max_step(way.view(), at, {free, fetch});
    fetch.now("first guess");
  }
  system_.potential.reach(at);
  std::vector<double> alpha(model.envs);
  for (Index e = 0; e < model.envs; ++e) alpha[e] = whose[e] && free[e] >= 1 ? 1 : 0;
  Energies moved, there;
  energies_.find(std::as_const(q).view(), at, fetch);
  if (supports.n > 0) {
    advance(std::as_const(q).view(), supports, alpha, model, moved_);
    system_.potential.energies(std::as_const(moved_).view(), at, moved, fetch);
    advance(std::as_const(q).view(), way.view(), alpha, model, trial_);
  } else {  // not `advance`, by which supports would land on their targets
    trial_.copy_from(q);
    add_scaled(way.view(), alpha, model.block_env.view(), trial_);
    if (model.ties.any()) model.ties.place(trial_.view());
  }
  system_.potential.energies(std::as_const(trial_).view(), at, there, fetch);
  if (lands_) system_.potential.foresee(std::as_const(trial_).view(), at, fetch);
  fetch.now("first guess energies");
  const std::vector<double> before = energies_.sum(supports.n > 0 ? moved : energies_.known()), after = energies_.sum(there);
  EnvMask taken(model.envs, 0);
  for (Index e = 0; e < model.envs; ++e) taken[e] = alpha[e] == 1 && std::isfinite(after[e]) && !(after[e] >= before[e]);
  landed_ = lands_ && taken == whose;
  lands_ = any(taken);
  energies_.begin_search(taken);
  for (Index e = 0; e < model.envs; ++e)
    if (taken[e]) copy_blocks(trial_, model.env_blocks[e], model.env_blocks[e + 1], q), energies_.forget(e);
  return taken;
}

}  // namespace mortise::solver
