#include "solver/adjoint.h"

#include "solver/kernels.h"
#include "solver/simulation.h"

namespace mortise::solver {
namespace {

double dot_of(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

// What the samples of a contact would take back at their gaps, along z at points.
double layer_along(const model::ContactView& contact, const std::vector<Vec3>& z) {
  double sum = 0;
  for (const model::ContactSample& s : contact.samples.download()) {
    const Vec3 n(s.normal[0], s.normal[1], s.normal[2]);
    double closing = 0;
    for (Index k = 0; k < s.points; ++k) closing += s.weight[k] * n.dot(z[s.point[k]]);
    sum += s.stiffness * s.gap * closing;
  }
  return sum;
}

// What forces of a store are along z at blocks.
double along(effects::Effect& store, device::View<const Vec3> q, device::View<const Vec3> z) {
  const std::unique_ptr<effects::Linearisation> at = store.linearisation();
  store.linearise(q, {}, *at);
  const linalg::StencilView of = at->stencils.view();
  return device::sum("adjoint.along", of.block.n, [=] MORTISE_HD(Index i) { return of.block[i] < 0 ? 0.0 : of.grad[i].dot(z[of.block[i]]); });
}

// What they are with a fault mended.
double mended_along(effects::Effect& store, effects::Fault fault, device::View<const Vec3> q, device::View<const Vec3> z) {
  store.mend(fault, 1);
  store.keep_pace(store, q);
  const double mended = along(store, q, z);
  store.mend(fault, 0);
  return mended;
}

// Where what is tied to a body goes with it, slides on it go as well, across their axes, and what slides on these.
void carry_slides(const model::Model& model, const std::vector<Mat3>& P, std::vector<Vec3>& E) {
  const std::vector<model::Guided> slides = model::guided(model);
  for (std::size_t round = 0; round < slides.size(); ++round) {
    device::Buffer<Vec3> carried(E);
    model.ties.carry(carried.view());
    const std::vector<Vec3> with = carried.download();
    for (const model::Guided& g : slides) {
      if (g.carrier == model::Tie::kWorld) continue;
      const Vec3& e = with[model.bodies[g.carrier].block_begin];
      const Index b = model.bodies[g.slider].block_begin;
      E[b] = e - P[b] * e;
    }
  }
}

}  // namespace

Adjoint Simulation::adjoint(const Functional& Q) {
  System& system = newton_.system();
  if (!tangent_) tangent_ = std::make_unique<Tangent>(system);
  if (tangent_step_ != step_[0]) tangent_->linearise(model_.q);
  tangent_step_ = step_[0];
  const std::vector<Mat3> P = model_.projector.download();

  // dQ/dq + J^T T (I - P) E: what supports move takes along what is tied to it
  std::vector<Vec3> w(model_.blocks, Vec3::Zero()), E = w;
  if (!Q.points.empty()) {
    const std::vector<Index> offset = model_.point_offset.download(), block = model_.point_block.download();
    const std::vector<double> weight = model_.point_weight.download();
    for (Index p = 0; p < model_.points; ++p)
      for (Index k = offset[p]; k < offset[p + 1]; ++k) w[block[k]] += weight[k] * Vec3(Q.points[3 * p], Q.points[3 * p + 1], Q.points[3 * p + 2]);
  }
  if (Q.body >= 0) {
    const model::Body& body = model_.bodies.at(Q.body);
    const Index end = body.type == model::BodyType::stiff ? body.block_begin + 1 : body.block_end;
    for (Index b = body.block_begin; b < end; ++b) E[b] = Vec3::Unit(Q.axis) - P[b] * Vec3::Unit(Q.axis);
    carry_slides(model_, P, E);
  }
  device::Buffer<Vec3> gradient(w), supported(E), JE, f(system.rows.count()), lambda, way;
  if (model_.ties.any()) model_.ties.fold(gradient.view()), model_.ties.carry(supported.view());
  if (Q.body >= 0) {
    tangent_->product(std::as_const(supported).view(), true, JE);
    add(std::as_const(JE).view(), gradient);
  }
  device::clear(f.view().p, f.size() * sizeof(Vec3));
  add_to_rows(std::as_const(gradient).view(), model_.working(system.rows.env), system.rows.block.view(), system.rows.projector.view(), f.view());
  tangent_->solve(std::as_const(f).view(), true, lambda);

  Adjoint out;
  out.exact = tangent_->assembled();
  out.residual = dot_of(lambda.download(), tangent_->forces().download());
  system.to_blocks(std::as_const(lambda).view(), {}, EnvMask(1, 1), way);
  std::vector<Vec3> z = way.download();
  const std::vector<Vec3> moved = supported.download();
  for (std::size_t b = 0; b < z.size(); ++b) z[b] = moved[b] - z[b];
  const device::Buffer<Vec3> of_blocks(z);
  device::Buffer<Vec3> y;
  model_.points_of(of_blocks.view(), y);
  const std::vector<Vec3> at_points = y.download();
  for (std::size_t k = 0; k < effects_.size(); ++k)
    if (effects_[k]->kind().role == effects::Role::contact) out.layer += layer_along(tangent_->at().of[k]->contact, at_points);
  for (const auto& effect : effects_) {
    if (effect->kind().role != effects::Role::store) continue;
    const device::View<const Vec3> q = std::as_const(model_.q).view();
    const double as_it_is = along(*effect, q, of_blocks.view());
    out.mesh += mended_along(*effect, effects::Fault::mesh, q, of_blocks.view()) - as_it_is;
    out.volumes += mended_along(*effect, effects::Fault::volumes, q, of_blocks.view()) - as_it_is;
  }
  for (const Vec3& v : at_points) out.points.insert(out.points.end(), {v[0], v[1], v[2]});
  return out;
}

}  // namespace mortise::solver
