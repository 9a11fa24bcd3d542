#include "effects/affine_body/affine_body.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "effects/body_blocks.h"
#include "effects/list.h"

namespace mortise::effects {
namespace {

const ParamTable kTable{"effect affine_body",
                        "Keeps stiff bodies from deforming.",
                        {param::positive(param::number("stiffness", Unit::pressure, "100 MPa", 0,
                                                       "Penalty on strain of the body; well above the moduli of what touches it."))}};

struct StiffBody {
  Index first;  // block of a1; a2 and a3 follow
  double Vk;    // [J]
};

MORTISE_HD inline Mat3 columns(Positions q, Index first) {
  Mat3 A;
  for (int i = 0; i < 3; ++i) A.col(i) = q[first + i];
  return A;
}

class AffineBody final : public Effect {
 public:
  AffineBody(const Params& params, model::Model& model) : model_(model) {
    const double stiffness = params.number("stiffness");
    std::vector<StiffBody> bodies;
    std::vector<Index> body_env;
    for (const model::Body& body : model.bodies) {
      if (body.type != model::BodyType::stiff) continue;
      bodies.push_back({body.block_begin + 1, body.volume * stiffness});
      body_env.push_back(body.env);
    }
    bodies_.upload(bodies);
    env_offset_ = env_offsets(body_env, model.envs);
    write_pattern();
  }

  // Not in the constructor: nvcc takes no kernel there.
  void write_pattern() {
    stencils_.resize_uniform(bodies_.size(), 3);
    const linalg::StencilView out = stencils_.view();
    const View<const StiffBody> list = std::as_const(bodies_).view();
    device::parallel_for("affine_body.pattern", list.n, [=] MORTISE_HD(Index s) {
      for (int i = 0; i < 3; ++i) out.block[3 * s + i] = list[s].first + i;
    });
    stencils_.pattern_changed();
  }

  std::string_view name() const override { return "affine_body"; }

  void plan(Plan& out) const override {
    out.buffers.push_back({"stencils", stencils_.bytes()});
    out.buffers.push_back({"bodies", bodies_.bytes()});
    for (const char* k : {"affine_body.pattern", "affine_body.energy", "affine_body.assemble", "affine_body.defect"}) out.kernels.push_back(k);
  }

  void energy(Positions q, device::EnvValues per_env) override {
    const View<const StiffBody> list = std::as_const(bodies_).view();
    device::env_sum(
        "affine_body.energy", env_offset_,
        [=] MORTISE_HD(Index s) { return affine_body::energy(list[s].Vk, columns(q, list[s].first)); }, per_env);
  }

  linalg::StencilSet& assemble(Positions q, Curvature curvature) override {
    const View<const StiffBody> list = std::as_const(bodies_).view();
    const linalg::StencilView out = stencils_.view();
    device::parallel_for("affine_body.assemble", list.n, [=] MORTISE_HD(Index s) {
      const Mat3 A = columns(q, list[s].first);
      const Mat3 g = affine_body::gradient(list[s].Vk, A);
      for (int i = 0; i < 3; ++i) out.grad[3 * s + i] = g.col(i);
      if (curvature.wanted) affine_body::hessian(list[s].Vk, A, curvature.concave, out.hess.p + 6 * s);
    });
    return stencils_;
  }

  // How far the worst body is from rigid: |A^T A - I|_F, about twice its largest strain.
  void report(FieldSink& sink) override {
    const View<const StiffBody> list = std::as_const(bodies_).view();
    const Positions q = std::as_const(model_.q).view();
    const double worst =
        device::max("affine_body.defect", list.n, 0, [=] MORTISE_HD(Index s) { return affine_body::defect(columns(q, list[s].first)).norm(); });
    sink.scalar("affine_body", "rigidity_defect", "1", worst);
    sink.scalar("affine_body", "energy", "J", energy_now(q, model_.envs));
  }

 private:
  model::Model& model_;
  device::Buffer<StiffBody> bodies_;
  std::vector<Index> env_offset_;
  linalg::StencilSet stencils_;
};

}  // namespace

Kind affine_body_kind() {
  return {"affine_body", "stiff bodies keep their shape", &kTable,
          [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<AffineBody>(p, m); },
          {"Lan, Kaufman, Li, Jiang, Yang: Affine Body Dynamics: Fast, Stable and Intersection-free Simulation of Stiff Materials. ACM TOG 41(4), 2022"}};
}

}  // namespace mortise::effects
