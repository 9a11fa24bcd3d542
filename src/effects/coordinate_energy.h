#pragma once
// Energies of the coordinates of joints, one per joint: what stops and drives have in common. Law: energy(x), first(x), second(x) >= 0 of the
// coordinate x [rad or m], and up(x), down(x): how far a step of Newton's method may go from there, INFINITY where it does not matter.
#include <utility>
#include <vector>

#include "effects/body_blocks.h"
#include "effects/effect.h"
#include "model/coordinate.h"

namespace mortise::effects {

struct CoordinateLinearisation : Linearisation {
  device::Buffer<model::HingeDirections> there;
  std::size_t bytes() const override { return Linearisation::bytes() + there.bytes(); }
};

template <class Law>
class CoordinateEnergy {
 public:
  struct Item {
    model::Coordinate of;
    Law law;
  };
  // env: of every item, ascending.
  void set_environments(const std::vector<Index>& env, Index envs) { env_offset_ = env_offsets(env, envs); }
  void upload(const std::vector<Item>& items) { items_.upload(items); }
  Index size() const { return items_.size(); }
  std::size_t bytes() const { return items_.bytes(); }

  void energy(const char* kernel, Positions q, device::EnvValues per_env) const {
    if (items_.empty()) return;
    const View<const Item> list = items_.view();
    device::env_sum(
        kernel, env_offset_, [=] MORTISE_HD(Index i) { return list[i].law.energy(model::coordinate(list[i].of, model::reading(list[i].of, q))); },
        per_env);
  }

  // Of laws that hold energy: how much at q, and what of the forces there that holds it does along `move`, with the other sign.
  void stored(const char* kernel, Positions q, Positions move, device::EnvValues held, device::EnvValues along) const {
    if (items_.empty()) return;
    const View<const Item> list = items_.view();
    device::env_sum(
        kernel, env_offset_, [=] MORTISE_HD(Index i) { return list[i].law.stored(model::coordinate(list[i].of, model::reading(list[i].of, q))); },
        held);
    device::env_sum(
        kernel, env_offset_,
        [=] MORTISE_HD(Index i) {
          const model::HingeDirections d = model::reading(list[i].of, q);
          return list[i].law.storing(model::coordinate(list[i].of, d)) *
                 model::coordinate_rate(list[i].of, d, model::reading(list[i].of, move, true));
        },
        along);
  }

  void linearise(const char* kernel, const model::Model& model, Positions q, Want want, Linearisation& at) const {
    if (items_.empty()) return;
    const bool fresh = want.forces && at.stencils.resize_uniform(items_.size(), model::kCoordinateBlocks);
    if (want.forces && want.matrix.wanted) at.stencils.need_hessian();
    fill(kernel, model, q, want, at);
    if (fresh) at.stencils.pattern_changed();
  }
  // The same where the set has room for these stencils before others.
  void fill(const char* kernel, const model::Model& model, Positions q, Want want, Linearisation& at) const {
    auto& mine = static_cast<CoordinateLinearisation&>(at);
    mine.there.resize(items_.size());
    const View<const Item> list = items_.view();
    const View<model::HingeDirections> there = mine.there.view();
    const bool forces = want.forces;
    const Curvature curvature = want.matrix;
    const View<const Index> env = std::as_const(model.block_env).view();
    const linalg::StencilView out = at.stencils.view();
    device::parallel_for(kernel, list.n, [=] MORTISE_HD(Index i) {
      const Item item = list[i];
      const model::HingeDirections d = model::reading(item.of, q);
      there[i] = d;
      if (!forces) return;
      const double x = model::coordinate(item.of, d), concavity = curvature.wanted ? curvature.concavity(env[item.of.any_block()]) : 0;
      const Index first = model::kCoordinateBlocks * i;
      model::coordinate_stencil(item.of, d, item.law.first(x), item.law.second(x), concavity, out.block.p + first, out.grad.p + first,
                                curvature.wanted ? out.hess.p + linalg::pair_count(model::kCoordinateBlocks) * i : nullptr);
    });
  }

  // No way further than the law allows, nor than what can be counted of turns since the step began.
  void max_step(const char* kernel, View<const Vec3> dq, const Linearisation& at, device::EnvValues alpha) const {
    if (items_.empty()) return;
    const View<const Item> list = items_.view();
    const View<const model::HingeDirections> there = static_cast<const CoordinateLinearisation&>(at).there.view();
    device::env_min(
        kernel, env_offset_,
        [=] MORTISE_HD(Index i) {
          const Item item = list[i];
          const double x = model::coordinate(item.of, there[i]);
          return model::coordinate_way(item.of, there[i], model::reading(item.of, dq, true), x, item.law.up(x), item.law.down(x));
        },
        alpha);
  }

 private:
  device::Buffer<Item> items_;
  std::vector<Index> env_offset_{0};
};

}  // namespace mortise::effects
