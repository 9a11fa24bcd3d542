#include "effects/gravity/gravity.h"

#include <utility>

#include "effects/body_blocks.h"
#include "effects/list.h"

namespace mortise::effects {
namespace {

const ParamTable kTable{"effect gravity",
                        "Weight of all bodies.",
                        {param::of(Param::Kind::vec3, "acceleration", Unit::acceleration, "[0, 0, -9.81]", "Acceleration of free fall.")}};

struct Weight {
  Index block;
  Vec3 force;  // [N]
};

class Gravity final : public Effect {
 public:
  Gravity(const Params& params, model::Model& model) : model_(model) {
    std::vector<Vec3> g;
    for (Index e = 0; e < model.envs; ++e) g.push_back(model.input.effect_of(params, e).vec3("acceleration"));
    const auto row = model.mass.row_offset.download(), column = model.mass.column.download();
    const auto value = model.mass.value.download();
    const auto env = model.block_env.download();
    const std::vector<double> weight = translation_weight(model);
    std::vector<Weight> weights;
    std::vector<Index> weight_env;
    for (Index i = 0; i < model.blocks; ++i) {
      double mass = 0;
      for (Index k = row[i]; k < row[i + 1]; ++k) mass += value[k] * weight[column[k]];
      if (mass == 0) continue;
      weights.push_back({i, mass * g[env[i]]});
      weight_env.push_back(env[i]);
    }
    weights_.upload(weights);
    env_offset_ = env_offsets(weight_env, model.envs);
  }

  const Kind& kind() const override;
  std::vector<PlanItem> plan() const override { return {{"weights", weights_.bytes()}}; }

  void energy(Positions q, const Linearisation&, device::EnvValues per_env) override {
    const View<const Weight> w = std::as_const(weights_).view();
    const Positions rest = std::as_const(model_.rest).view();
    device::env_sum(
        "gravity.energy", env_offset_, [=] MORTISE_HD(Index s) { return gravity::energy(w[s].force, q[w[s].block], rest[w[s].block]); }, per_env);
  }

  // The force is constant, but written anew: the solver may have used the stencils as its work space.
  void linearise(Positions, Want want, Linearisation& at) override {
    if (!want.forces) return;
    const bool fresh = at.stencils.resize_uniform(weights_.size(), 1);
    const bool stiffness = want.matrix.wanted && !at.stencils.has_hessian();
    if (stiffness) at.stencils.need_hessian();
    const linalg::StencilView out = at.stencils.view();
    const View<const Weight> w = std::as_const(weights_).view();
    device::parallel_for("gravity.assemble", w.n, [=] MORTISE_HD(Index s) {
      out.block[s] = w[s].block;
      out.grad[s] = gravity::gradient(w[s].force);
      if (stiffness) out.hess[s] = Mat3::Zero();
    });
    if (fresh) at.stencils.pattern_changed();
  }

  void report(const FieldSinks& sinks, const Linearisation& at) override {
    sinks.scalar("gravity", "energy", "J", energies_now(std::as_const(model_.q).view(), at, model_.envs));
  }

 private:
  model::Model& model_;
  device::Buffer<Weight> weights_;
  std::vector<Index> env_offset_;
};

}  // namespace

const Kind& gravity_kind() {
  static const Kind kind = Kind{
      "gravity", Role::load, "weight of all bodies", &kTable, [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> {
        return std::make_unique<Gravity>(p, m);
      }}.differing_in({"acceleration"});
  return kind;
}

const Kind& Gravity::kind() const { return gravity_kind(); }

}  // namespace mortise::effects
