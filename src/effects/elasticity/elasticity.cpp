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
  View<const geometry::Midsides> midsides;
  View<const Index> first_point;
  View<const Mat3> dm_inverse;
  View<const double> volume, mu, lambda;
  View<const std::uint8_t> material;
  Index size() const { return tet.n; }
  MORTISE_HD bool quadratic(Index t) const { return first_point[t + 1] - first_point[t] > 1; }
  MORTISE_HD Index node(Index t, int a) const { return a < 4 ? tet[t].v[a] : midsides[t].v[a - 4]; }
  MORTISE_HD elasticity::Element element(Index t, int point) const {
    const Index p = first_point[t] + point;
    return {dm_inverse[p], volume[p], mu[t], lambda[t], static_cast<model::MaterialModel>(material[t])};
  }
  // Of a linear tetrahedron.
  MORTISE_HD Mat3 deformation(Index t, Positions q) const {
    const Tet v = tet[t];
    return elasticity::deformation_gradient(dm_inverse[first_point[t]], q[v.v[0]], q[v.v[1]], q[v.v[2]], q[v.v[3]]);
  }
  MORTISE_HD void nodes(Index t, Positions q, Vec3 x[10]) const {
    for (int a = 0; a < 10; ++a) x[a] = q[node(t, a)];
  }
};

Tets tets_of(const model::Volume& v) {
  return {v.tets.view(), v.midsides.view(), v.first_point.view(), v.dm_inverse.view(), v.rest_volume.view(), v.lame_mu.view(), v.lame_lambda.view(), v.material.view()};
}

// Deformation gradient at every point of integration, and the point's properties: visit(point, element, F).
template <class Visit>
MORTISE_HD inline void at_points(const Tets& tets, Index t, Positions q, Visit&& visit) {
  if (!tets.quadratic(t)) {
    visit(0, tets.element(t, 0), tets.deformation(t, q));
    return;
  }
  Vec3 x[10], g[10];
  tets.nodes(t, q, x);
  for (int p = 0; p < geometry::kTetPoints; ++p) {
    const elasticity::Element e = tets.element(t, p);
    elasticity::quadratic_gradients(e.dm_inverse, p, g);
    visit(p, e, elasticity::quadratic_deformation(g, x));
  }
}

// concave: share of negative curvature; no Hessian where hess is null.
MORTISE_HD inline void assemble_quadratic(const Tets& tets, Index t, Positions q, double concave, Vec3* grad, Mat3* hess) {
  Vec3 x[10], g[10];
  tets.nodes(t, q, x);
  for (int a = 0; a < 10; ++a) grad[a] = Vec3::Zero();
  for (Index i = 0; hess && i < linalg::pair_count(10); ++i) hess[i] = Mat3::Zero();
  for (int p = 0; p < geometry::kTetPoints; ++p) {
    const elasticity::Element e = tets.element(t, p);
    elasticity::quadratic_gradients(e.dm_inverse, p, g);
    const Mat3 F = elasticity::quadratic_deformation(g, x);
    elasticity::add_quadratic_gradient(e, F, g, grad);
    if (hess) elasticity::add_hessian(e, F, concave, 10, g, hess);
  }
}

// sqrt(3/2) |dev sigma|
double von_mises(const double* s) {
  const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
  return std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

class Elasticity final : public Effect {
 public:
  explicit Elasticity(model::Model& model) : model_(model) {}

  const Kind& kind() const override;

  void write_pattern(linalg::StencilSet& stencils) const {
    const Tets tets = tets_of(model_.volume);
    if (tets.midsides.n == 0) {
      stencils.resize_uniform(tets.size(), 4);
    } else {
      device::Buffer<Index> counts(tets.size() + 1);
      const View<Index> count = counts.view();
      device::parallel_for("elasticity.count_nodes", tets.size(), [=] MORTISE_HD(Index t) { count[t] = tets.quadratic(t) ? 10 : 4; });
      stencils.resize(std::move(counts));
    }
    const linalg::StencilView out = stencils.view();
    device::parallel_for("elasticity.pattern", tets.size(), [=] MORTISE_HD(Index t) {
      for (int a = 0; a < out.blocks(t); ++a) out.block[out.offset[t] + a] = tets.node(t, a);
    });
    stencils.pattern_changed();
  }

  void energy(Positions q, const Linearisation&, device::EnvValues per_env) override {
    const Tets tets = tets_of(model_.volume);
    device::env_sum(
        "elasticity.energy", model_.volume.env_offset,
        [=] MORTISE_HD(Index t) {
          double sum = 0;
          at_points(tets, t, q, [&sum](int, const elasticity::Element& e, const Mat3& F) { sum += elasticity::energy(e, F); });
          return sum;
        },
        per_env);
  }

  void linearise(Positions q, Want want, Linearisation& at) override {
    if (!want.forces) return;
    if (!at.shaped) write_pattern(at.stencils), at.shaped = true;
    const Curvature curvature = want.matrix;
    if (curvature.wanted) at.stencils.need_hessian();
    const Tets tets = tets_of(model_.volume);
    const View<const Index> env = std::as_const(model_.block_env).view();
    const linalg::StencilView out = at.stencils.view();
    device::parallel_for("elasticity.assemble", tets.size(), [=] MORTISE_HD(Index t) {
      Vec3* grad = out.grad.p + out.offset[t];
      Mat3* hess = curvature.wanted ? out.hess.p + out.hess_offset[t] : nullptr;
      const double concave = curvature.share(env[tets.tet[t].v[0]]);
      if (tets.quadratic(t)) {
        assemble_quadratic(tets, t, q, concave, grad, hess);
        return;
      }
      const elasticity::Element e = tets.element(t, 0);
      const Mat3 F = tets.deformation(t, q);
      elasticity::gradient(e, F, grad);
      if (hess) elasticity::hessian(e, F, concave, hess);
    });
  }

  void report(FieldSink& sink, const Linearisation& at) override {
    const Tets tets = tets_of(model_.volume);
    const Positions q = std::as_const(model_.q).view();
    // Per point of integration, in Voigt order xx yy zz xy yz zx, then det F.
    device::Buffer<double> buffer(7 * tets.volume.n);
    const View<double> out = buffer.view();
    device::parallel_for("elasticity.report", tets.size(), [=] MORTISE_HD(Index t) {
      double* o = out.p + 7 * tets.first_point[t];
      at_points(tets, t, q, [o](int p, const elasticity::Element& e, const Mat3& F) {
        const Mat3 s = elasticity::cauchy_stress(e.model, F, e.mu, e.lambda);
        double* at = o + 7 * p;
        at[0] = s(0, 0), at[1] = s(1, 1), at[2] = s(2, 2), at[3] = s(0, 1), at[4] = s(1, 2), at[5] = s(2, 0);
        at[6] = elasticity::det3(F);
      });
    });
    const std::vector<double> host = buffer.download(), volume = model_.volume.rest_volume.download();
    const std::vector<Index> first = model_.volume.first_point.download();
    double least = volume.empty() ? 1 : host[6];
    for (std::size_t p = 0; p < volume.size(); ++p) least = std::min(least, host[7 * p + 6]);
    // Output cells, body after body: the tetrahedra of a soft body, quadratic ones with the mean over their volume; the surface
    // triangles of a stiff one, whose stress nobody knows.
    std::vector<double> stress, mises, of_points;
    for (const model::Body& body : model_.bodies) {
      for (Index t = body.tet_begin; t < body.tet_end; ++t) {
        double mean[6] = {}, all = 0;
        for (Index p = first[t]; p < first[t + 1]; ++p) all += volume[p];
        for (Index p = first[t]; p < first[t + 1]; ++p)
          for (int c = 0; c < 6; ++c) mean[c] += volume[p] / all * host[7 * p + c];
        stress.insert(stress.end(), mean, mean + 6);
        mises.push_back(von_mises(mean));
        for (Index p = first[t]; first[t + 1] - first[t] > 1 && p < first[t + 1]; ++p) of_points.insert(of_points.end(), host.data() + 7 * p, host.data() + 7 * p + 6);
      }
      if (body.type == model::BodyType::soft) continue;
      stress.insert(stress.end(), 6 * (body.triangle_end - body.triangle_begin), std::nan(""));
      mises.insert(mises.end(), body.triangle_end - body.triangle_begin, std::nan(""));
    }
    if (!of_points.empty()) sink.rows("elasticity", "point_stress", "Pa", 6, of_points);
    sink.cells("cauchy_stress", "Pa", 6, stress);
    sink.cells("von_mises", "Pa", 1, mises);
    sink.scalar("elasticity", "det_F_min", "1", least);
    sink.scalar("elasticity", "energy", "J", energy_now(q, at, model_.envs));
  }

 private:
  model::Model& model_;
};

}  // namespace

const Kind& elasticity_kind() {
  static const Kind kind{"elasticity", Role::store, "soft bodies resist deformation (linear, corotated, stable neo-Hookean)", &kTable,
          [](const Params&, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<Elasticity>(m); },
          {"Smith, de Goes, Kim: Stable Neo-Hookean Flesh Simulation. ACM TOG 37(2), 2018",
           "Smith, de Goes, Kim: Analytic Eigensystems for Isotropic Distortion Energies. ACM TOG 38(1), 2019",
           "Stomakhin, Howes, Schroeder, Teran: Energetically Consistent Invertible Elasticity. SCA 2012"},
          {},
          {"cauchy_stress", "von_mises"}};
  return kind;
}

const Kind& Elasticity::kind() const { return elasticity_kind(); }

}  // namespace mortise::effects
