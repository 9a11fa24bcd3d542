#pragma once
// Energies of the angles of hinges, one per hinge: what stops and drives of joints have in common. Law: energy(x), first(x), second(x) >= 0 of the angle x
// [rad], and up(x), down(x): how far a step of Newton's method may turn from there, INFINITY where it does not matter.
#include <utility>
#include <vector>

#include "effects/effect.h"
#include "effects/body_blocks.h"
#include "model/hinge.h"

namespace mortise::effects {

// The angle of a hinge with its turns counted on from the accepted state.
struct Angle {
  model::Hinge hinge;
  double at_rest, before;  // [rad]
  MORTISE_HD double of(const model::HingeDirections& d) const { return model::unwrapped(at_rest + model::hinge_angle(d), before); }
};

inline model::Hinge hinge_of(const model::Model& model, const model::Joint& j) {
  return model::hinge_about(j.axis, model.bodies[j.body].block_begin + 1, j.to == model::Tie::kWorld ? -1 : model.bodies[j.to].block_begin + 1);
}

struct HingeLinearisation final : Linearisation {
  device::Buffer<model::HingeDirections> there;
  std::size_t bytes() const override { return Linearisation::bytes() + there.bytes(); }
};

template <class Law>
class HingeEnergy {
 public:
  struct Item {
    Angle angle;
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
        kernel, env_offset_, [=] MORTISE_HD(Index i) { return list[i].law.energy(list[i].angle.of(model::directions(list[i].angle.hinge, q))); }, per_env);
  }

  void linearise(const char* kernel, const model::Model& model, Positions q, Want want, Linearisation& at) const {
    if (items_.empty()) return;
    auto& mine = static_cast<HingeLinearisation&>(at);
    mine.there.resize(items_.size());
    const View<const Item> list = items_.view();
    const View<model::HingeDirections> there = mine.there.view();
    const bool fresh = want.forces && at.stencils.resize_uniform(list.n, model::kHingeBlocks), forces = want.forces;
    const Curvature curvature = want.matrix;
    if (forces && curvature.wanted) at.stencils.need_hessian();
    const View<const Index> env = std::as_const(model.block_env).view();
    const linalg::StencilView out = at.stencils.view();
    device::parallel_for(kernel, list.n, [=] MORTISE_HD(Index i) {
      const Item item = list[i];
      const model::HingeDirections d = model::directions(item.angle.hinge, q);
      there[i] = d;
      if (!forces) return;
      const double x = item.angle.of(d), share = curvature.wanted ? curvature.share(env[item.angle.hinge.child]) : 0;
      const Index first = model::kHingeBlocks * i;
      model::hinge_stencil(item.angle.hinge, d, item.law.first(x), item.law.second(x), share, out.block.p + first, out.grad.p + first,
                           curvature.wanted ? out.hess.p + linalg::pair_count(model::kHingeBlocks) * i : nullptr);
    });
    if (fresh) at.stencils.pattern_changed();
  }

  // No way further than the law allows, nor than what can be counted of turns since the step began.
  void max_step(const char* kernel, View<const Vec3> dq, const Linearisation& at, device::EnvValues alpha) const {
    if (items_.empty()) return;
    const View<const Item> list = items_.view();
    const View<const model::HingeDirections> there = static_cast<const HingeLinearisation&>(at).there.view();
    device::env_min(
        kernel, env_offset_,
        [=] MORTISE_HD(Index i) {
          const Item item = list[i];
          const double x = item.angle.of(there[i]), turned = x - item.angle.before;
          const double up = item.law.up(x), down = item.law.down(x), most_up = model::kFarthest - turned, most_down = model::kFarthest + turned;
          return model::hinge_way(there[i], model::directions(item.angle.hinge, dq, true), up < most_up ? up : most_up, down < most_down ? down : most_down);
        },
        alpha);
  }

 private:
  device::Buffer<Item> items_;
  std::vector<Index> env_offset_{0};
};

}  // namespace mortise::effects
