#include "effects/elasticity/elasticity.h"

#include <algorithm>

#include "effects/list.h"
#include "model/model.h"

namespace mortise::effects {
namespace {

const ParamTable kTable{"effect elasticity", "Hyperelastic energy of soft bodies; the law is the one of each body's material.", {}};

// Everything a kernel needs of the tetrahedra.
struct Tets {
  View<const Tet> tet;
  View<const Mat3> dm_inverse;
  View<const double> volume, mu, lambda;
  View<const std::uint8_t> material;
  Index size() const { return tet.n; }
  MORTISE_HD elasticity::Element element(Index t) const {
    return {dm_inverse[t], volume[t], mu[t], lambda[t], static_cast<model::MaterialModel>(material[t])};
  }
  MORTISE_HD Mat3 deformation(Index t, Positions q) const {
    const Tet v = tet[t];
    return elasticity::deformation_gradient(dm_inverse[t], q[v.v[0]], q[v.v[1]], q[v.v[2]], q[v.v[3]]);
  }
};

Tets tets_of(const model::Volume& v) {
  return {v.tets.view(), v.dm_inverse.view(), v.rest_volume.view(), v.lame_mu.view(), v.lame_lambda.view(), v.material.view()};
}

// sqrt(3/2) |dev sigma|
double von_mises(const double* s) {
  const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
  return std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

class Elasticity final : public Effect {
 public:
  explicit Elasticity(model::Model& model) : model_(model) {
    write_pattern();
  }

  // Not in the constructor: nvcc takes no kernel there.
  void write_pattern() {
    const Tets tets = tets_of(model_.volume);
    stencils_.resize_uniform(tets.size(), 4);
    const linalg::StencilView out = stencils_.view();
    device::parallel_for("elasticity.pattern", tets.size(), [=] MORTISE_HD(Index t) {
      for (int a = 0; a < 4; ++a) out.block[4 * t + a] = tets.tet[t].v[a];
    });
    stencils_.pattern_changed();
  }

  std::string_view name() const override { return "elasticity"; }

  void plan(Plan& out) const override {
    out.buffers.push_back({"stencils", stencils_.bytes()});
    for (const char* k : {"elasticity.pattern", "elasticity.energy", "elasticity.assemble", "elasticity.report"}) out.kernels.push_back(k);
  }

  void energy(Positions q, std::vector<double>& per_env) override {
    const Tets tets = tets_of(model_.volume);
    device::env_sum(
        "elasticity.energy", model_.volume.env_offset,
        [=] MORTISE_HD(Index t) { return elasticity::energy(tets.element(t), tets.deformation(t, q)); }, per_env);
  }

  linalg::StencilSet& assemble(Positions q, bool hessian) override {
    const Tets tets = tets_of(model_.volume);
    const linalg::StencilView out = stencils_.view();
    device::parallel_for("elasticity.assemble", tets.size(), [=] MORTISE_HD(Index t) {
      const elasticity::Element e = tets.element(t);
      const Mat3 F = tets.deformation(t, q);
      elasticity::gradient(e, F, out.grad.p + 4 * t);
      if (hessian) elasticity::hessian(e, F, true, out.hess.p + 10 * t);
    });
    return stencils_;
  }

  void report(FieldSink& sink) override {
    const Tets tets = tets_of(model_.volume);
    const Positions q = std::as_const(model_.q).view();
    const Index n = tets.size();
    // Voigt order xx yy zz xy yz zx, then det F
    device::Buffer<double> buffer(7 * n);
    const View<double> out = buffer.view();
    device::parallel_for("elasticity.report", n, [=] MORTISE_HD(Index t) {
      const elasticity::Element e = tets.element(t);
      const Mat3 F = tets.deformation(t, q);
      const Mat3 s = elasticity::cauchy_stress(e.model, F, e.mu, e.lambda);
      double* o = out.p + 7 * t;
      o[0] = s(0, 0), o[1] = s(1, 1), o[2] = s(2, 2), o[3] = s(0, 1), o[4] = s(1, 2), o[5] = s(2, 0);
      o[6] = elasticity::det3(F);
    });
    const std::vector<double> host = buffer.download();
    double least = n > 0 ? host[6] : 1;
    for (Index t = 0; t < n; ++t) least = std::min(least, host[7 * t + 6]);
    // Output cells, body after body: the tetrahedra of a soft body; the surface triangles of a stiff one, whose stress nobody knows.
    std::vector<double> stress, mises;
    for (const model::Body& body : model_.bodies) {
      for (Index t = body.tet_begin; t < body.tet_end; ++t) {
        stress.insert(stress.end(), host.data() + 7 * t, host.data() + 7 * t + 6);
        mises.push_back(von_mises(host.data() + 7 * t));
      }
      if (body.type == model::BodyType::soft) continue;
      stress.insert(stress.end(), 6 * (body.triangle_end - body.triangle_begin), std::nan(""));
      mises.insert(mises.end(), body.triangle_end - body.triangle_begin, std::nan(""));
    }
    sink.cells("cauchy_stress", "Pa", 6, stress);
    sink.cells("von_mises", "Pa", 1, mises);
    sink.scalar("elasticity", "det_F_min", "1", least);
    std::vector<double> per_env(model_.envs, 0.0);
    energy(q, per_env);
    double total = 0;
    for (double e : per_env) total += e;
    sink.scalar("elasticity", "energy", "J", total);
  }

 private:
  model::Model& model_;
  linalg::StencilSet stencils_;
};

}  // namespace

Kind elasticity_kind() {
  return {"elasticity", "soft bodies resist deformation (linear, corotated, stable neo-Hookean)", &kTable,
          [](const Params&, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<Elasticity>(m); },
          {"Smith, de Goes, Kim: Stable Neo-Hookean Flesh Simulation. ACM TOG 37(2), 2018",
           "Smith, de Goes, Kim: Analytic Eigensystems for Isotropic Distortion Energies. ACM TOG 38(1), 2019",
           "Stomakhin, Howes, Schroeder, Teran: Energetically Consistent Invertible Elasticity. SCA 2012"}};
}

}  // namespace mortise::effects
