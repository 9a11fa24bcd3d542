#include <algorithm>

#include "effects/elasticity/mean_volume.h"
#include "effects/elasticity/missed.h"
#include "effects/elasticity/tets.h"
#include "effects/list.h"
#include "effects/per_environment.h"

namespace mortise::effects {
namespace {

using elasticity::at_points;
using elasticity::Tets;

const ParamTable kTable{"effect elasticity", "Hyperelastic energy of soft bodies; the law is the one of each body's material.", {}};

// concave: share of negative curvature; no Hessian where hess is null.
MORTISE_HD inline void assemble_quadratic(const Tets& tets, Index t, Positions q, double concave, Vec3* grad, Mat3* hess) {
  Vec3 x[10], g[10];
  tets.nodes(t, q, x);
  for (int a = 0; a < 10; ++a) grad[a] = Vec3::Zero();
  for (Index i = 0; hess && i < linalg::pair_count(10); ++i) hess[i] = Mat3::Zero();
  const double lambda = tets.mean_lambda[t];
  elasticity::Mean mean;
  if (lambda > 0) mean = elasticity::mean_of_quadratic(tets, t, x);
  Vec3 slope[10];  // of V <theta> [m^2]
  for (int a = 0; a < 10; ++a) slope[a] = Vec3::Zero();
  for (int p = 0; p < geometry::kTetPoints; ++p) {
    elasticity::Element e = tets.element(t, p);
    e.pressure = lambda * mean.dilation;
    elasticity::quadratic_gradients(e.dm_inverse, p, g);
    const Mat3 F = elasticity::quadratic_deformation(g, x);
    elasticity::add_quadratic_gradient(e, F, g, grad);
    if (hess && lambda > 0) {
      const Mat3 C = e.volume * elasticity::dilation_slope(e.model, F);
      for (int a = 0; a < 10; ++a) slope[a] += C * g[a];
    }
    if (hess) elasticity::add_hessian(e, F, concave, 10, g, hess);
  }
  if (!hess || !(lambda > 0)) return;
  for (int a = 0, place = 0; a < 10; ++a)
    for (int b = a; b < 10; ++b) hess[place++] += (lambda / mean.volume) * slope[a] * slope[b].transpose();
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
    const Tets tets(model_);
    const Index elements = tets.size(), clusters = model_.clusters.size();
    const View<const Index> first_node = model_.clusters.first_node.view(), node = model_.clusters.node.view();
    if (tets.midsides.n == 0 && clusters == 0) {
      stencils.resize_uniform(elements, 4);
    } else {
      device::Buffer<Index> counts(elements + clusters + 1);
      const View<Index> count = counts.view();
      device::parallel_for("elasticity.count_nodes", elements + clusters, [=] MORTISE_HD(Index s) {
        count[s] = s >= elements ? first_node[s - elements + 1] - first_node[s - elements] : tets.quadratic(s) ? 10 : 4;
      });
      stencils.resize(std::move(counts));
    }
    const linalg::StencilView out = stencils.view();
    device::parallel_for("elasticity.pattern", elements, [=] MORTISE_HD(Index t) {
      for (int a = 0; a < out.blocks(t); ++a) out.block[out.offset[t] + a] = tets.node(t, a);
    });
    if (clusters > 0)
      device::parallel_for("elasticity.cluster_pattern", node.n, [=] MORTISE_HD(Index i) { out.block[out.offset[elements] + i] = node[i]; });
    stencils.pattern_changed();
  }

  void energy(Positions q, const Linearisation&, device::EnvValues per_env) override {
    const Tets tets(model_);
    device::env_sum(
        "elasticity.energy", model_.working(model_.volume.env_offset),
        [=] MORTISE_HD(Index t) {
          double sum = 0;
          at_points(tets, t, q, [&](int, const elasticity::Element& e, const Mat3& F) {
            sum += elasticity::energy(e, F);
            if (e.pressure != 0) sum += 0.5 * e.volume * e.pressure * e.pressure / tets.mean_lambda[t];  // quadratic; of clusters below
          });
          return sum;
        },
        per_env);
    if (model_.clusters.size() > 0) elasticity::cluster_energy(tets, model_.clusters, q, model_.at_work, per_env);
  }

  void linearise(Positions q, Want want, Linearisation& at) override {
    if (!want.forces) return;
    if (!at.shaped) write_pattern(at.stencils), at.shaped = true;
    const Curvature curvature = want.matrix;
    if (curvature.wanted) at.stencils.need_hessian();
    Tets tets(model_);
    device::Buffer<double> pressure = with_pressures(tets, q);
    const View<const Index> env = std::as_const(model_.block_env).view();
    const linalg::StencilView out = at.stencils.view();
    device::parallel_for("elasticity.assemble", model_.working(model_.volume.env_offset), [=] MORTISE_HD(Index t) {
      Vec3* grad = out.grad.p + out.offset[t];
      Mat3* hess = curvature.wanted ? out.hess.p + out.hess_offset[t] : nullptr;
      const double concave = curvature.concavity(env[tets.tet[t].v[0]]);
      if (tets.quadratic(t)) {
        assemble_quadratic(tets, t, q, concave, grad, hess);
        return;
      }
      const elasticity::Element e = tets.element(t, 0);
      const Mat3 F = tets.deformation(t, q);
      elasticity::gradient(e, F, grad);
      if (hess) elasticity::hessian(e, F, concave, hess);
    });
    elasticity::cluster_stencils(tets, model_.clusters, q, tets.size(), curvature.wanted, model_.at_work, out);
    if (mended_ != 0 && missed_) missed_->add_to(out);
  }

  void mend(Fault fault, double share) override {
    if (fault == Fault::mesh || fault == Fault::volumes) mended_ = share, sheared_ = fault == Fault::mesh;
  }
  // With the stresses of the leader: of its own, what is mended would grow with it.
  void keep_pace(const Effect&, Positions q) override {
    if (mended_ == 0) return;
    if (!missed_) missed_ = std::make_unique<elasticity::Missed>(model_);
    Tets tets(model_);
    const device::Buffer<double> pressure = with_pressures(tets, q);
    missed_->mend(tets, q, mended_, sheared_);
  }

  void report(const FieldSinks& sinks, const Linearisation& at) override {
    Tets tets(model_);
    const Positions q = std::as_const(model_.q).view();
    const device::Buffer<double> pressure = with_pressures(tets, q);
    // Per point of integration, in Voigt order xx yy zz xy yz zx, then det F.
    device::Buffer<double> buffer(7 * tets.volume.n);
    const View<double> out = buffer.view();
    device::parallel_for("elasticity.report", tets.size(), [=] MORTISE_HD(Index t) {
      double* o = out.p + 7 * tets.first_point[t];
      at_points(tets, t, q, [o](int p, const elasticity::Element& e, const Mat3& F) {
        const Mat3 s = elasticity::cauchy_stress(e.model, F, e.mu, e.lambda, e.pressure);
        double* at = o + 7 * p;
        at[0] = s(0, 0), at[1] = s(1, 1), at[2] = s(2, 2), at[3] = s(0, 1), at[4] = s(1, 2), at[5] = s(2, 0);
        at[6] = elasticity::det3(F);
      });
    });
    const std::vector<double> host = buffer.download(), volume = model_.volume.rest_volume.download();
    const std::vector<Index> first = model_.volume.first_point.download();
    const std::vector<Index>& own = model_.volume.env_offset;
    std::vector<double> least(model_.envs, 1.0);
    for (Index e = 0; e < model_.envs; ++e) {
      if (first[own[e]] < first[own[e + 1]]) least[e] = host[7 * first[own[e]] + 6];
      for (Index p = first[own[e]]; p < first[own[e + 1]]; ++p) least[e] = std::min(least[e], host[7 * p + 6]);
    }
    // Output cells, body after body: the tetrahedra of a soft body, quadratic ones with the mean over their volume; the surface
    // triangles of a stiff one, whose stress nobody knows.
    std::vector<double> stress, mises;
    std::vector<std::vector<double>> of_points(model_.envs);
    for (const model::Body& body : model_.bodies) {
      for (Index t = body.tet_begin; t < body.tet_end; ++t) {
        double mean[6] = {}, all = 0;
        for (Index p = first[t]; p < first[t + 1]; ++p) all += volume[p];
        for (Index p = first[t]; p < first[t + 1]; ++p)
          for (int c = 0; c < 6; ++c) mean[c] += volume[p] / all * host[7 * p + c];
        stress.insert(stress.end(), mean, mean + 6);
        mises.push_back(von_mises(mean));
        for (Index p = first[t]; first[t + 1] - first[t] > 1 && p < first[t + 1]; ++p)
          of_points[body.env].insert(of_points[body.env].end(), host.data() + 7 * p, host.data() + 7 * p + 6);
      }
      if (body.type == model::BodyType::soft) continue;
      stress.insert(stress.end(), 6 * (body.triangle_end - body.triangle_begin), std::nan(""));
      mises.insert(mises.end(), body.triangle_end - body.triangle_begin, std::nan(""));
    }
    for (Index e = 0; e < sinks.size(); ++e)
      if (!of_points[e].empty()) sinks[e].rows("elasticity", "point_stress", "Pa", 6, of_points[e]);
    report_cells(sinks, model_, "cauchy_stress", "Pa", 6, stress);
    report_cells(sinks, model_, "von_mises", "Pa", 1, mises);
    sinks.scalar("elasticity", "det_F_min", "1", least);
    std::vector<double> energy = energies_now(q, at, model_.envs);
    if (mended_ != 0 && missed_) energy[0] += missed_->energy();
    sinks.scalar("elasticity", "energy", "J", energy);
  }

 private:
  // Gives the tetrahedra the pressures of their clusters at q, which live as long as what is returned.
  device::Buffer<double> with_pressures(Tets& tets, Positions q) const {
    device::Buffer<double> pressure;
    if (model_.clusters.size() == 0) return pressure;
    elasticity::cluster_pressures(tets, model_.clusters, q, model_.at_work, pressure);
    tets.pressure = std::as_const(pressure).view();
    return pressure;
  }

  model::Model& model_;
  double mended_ = 0;    // a share of what the mesh leaves out
  bool sheared_ = true;  // of all that, or else of changes of volume alone
  std::unique_ptr<elasticity::Missed> missed_;
};

}  // namespace

const Kind& elasticity_kind() {
  static const Kind kind{"elasticity",
                         Role::store,
                         "soft bodies resist deformation (linear, corotated, stable neo-Hookean)",
                         &kTable,
                         [](const Params&, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<Elasticity>(m); },
                         {"Smith, de Goes, Kim: Stable Neo-Hookean Flesh Simulation. ACM TOG 37(2), 2018",
                          "Smith, de Goes, Kim: Analytic Eigensystems for Isotropic Distortion Energies. ACM TOG 38(1), 2019",
                          "Bonet, Burton: A simple average nodal pressure tetrahedral element for incompressible and nearly incompressible dynamic "
                          "explicit applications. Commun. Numer. Meth. Engng 14, 1998",
                          "Stomakhin, Howes, Schroeder, Teran: Energetically Consistent Invertible Elasticity. SCA 2012"},
                         {},
                         {"cauchy_stress", "von_mises"}};
  return kind;
}

const Kind& Elasticity::kind() const { return elasticity_kind(); }

}  // namespace mortise::effects
