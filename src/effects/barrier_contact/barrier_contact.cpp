#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/error.h"
#include "effects/contact/active.h"
#include "effects/contact/proximity.h"
#include "effects/contact/report.h"
#include "effects/contact/start_check.h"
#include "effects/list.h"

namespace mortise::effects {
namespace {

using namespace contact;

const ParamTable kTable{
    "effect barrier_contact",
    "Bodies never touch: a barrier acts between surfaces nearer than d_hat (incremental potential contact).",
    {param::positive(param::number("d_hat", Unit::length, "0.1 mm", 0, "Distance at which contact begins to act")),
     param::positive(param::number("stiffness", Unit::pressure, "1 MPa", 0,
                                   "Pressure scale kappa: two flat surfaces press with kappa phi(gap/d_hat), which is kappa at "
                                   "0.53 d_hat and 4.3 kappa at d_hat/4")),
     param::choice("form", {"area_weighted", "classic"}, "area_weighted",
                   "area_weighted: pressures do not depend on the mesh; classic: every pair of primitives has the weight d_hat^2 "
                   "(stiffness kappa d_hat in N/m)"),
     param::optional(
         param::of(Param::Kind::pairs, "pairs", Unit::none, {}, "Pairs of bodies in contact; without it, all pairs"))}};

class BarrierContact final : public Effect {
 public:
  BarrierContact(const Params& p, model::Model& model) : model_(model), near_(model, p.number("d_hat")) {
    law_.d_hat = p.number("d_hat");
    law_.kappa = p.number("stiffness");
    law_.area_weighted = p.text("form") == "area_weighted";
    law_.edge_range = law_.area_weighted ? kEdgeShare * law_.d_hat : law_.d_hat;
    if (const Params* list = p.find("pairs")) pairs_ = *list;
    plane_area_.resize(static_cast<Index>(model.half_spaces.size()) * model.surface.vertices.size());
    model.publish(std::string(name()));
  }

  std::string_view name() const override { return "barrier_contact"; }

  void plan(Plan& out) const override {
    out.buffers.push_back({"stencils", stencils_.bytes()});
    out.buffers.push_back({"active terms", active_.terms.bytes()});
    out.buffers.push_back({"candidate pairs", near_.candidates().bytes()});
    for (const char* k : {"contact.near", "contact.terms", "contact.merge", "contact.point_terms", "contact.edge_terms",
                          "contact.count_blocks", "contact.assemble", "contact.samples", "contact.energy_points",
                          "contact.energy_edges", "contact.face_points"})
      out.kernels.push_back(k);
    if (!model_.half_spaces.empty())
      for (const char* k : {"contact.face_planes", "contact.near_planes", "contact.plane_terms", "contact.energy_planes",
                            "contact.limit_planes"})
        out.kernels.push_back(k);
  }

  void begin_step(const StepInfo& step) override {
    prepare();
    near_.begin_step(step);
    near_.locate(std::as_const(model_.q).view());
    if (!checked_) check_start(model_, near_.obstacles(scene()), near_.candidates(), near_.y());
    checked_ = true;
    weigh();
    update();
  }

  void energy(Positions q, device::EnvValues per_env) override {
    prepare();
    const std::vector<std::uint8_t> finite = near_.locate(q);
    contact::energy(scene(), near_.candidates(), near_.y(), near_.vertex_env(), per_env);
    forbid(finite, per_env);
  }

  linalg::StencilSet& assemble(Positions q, Curvature curvature) override {
    prepare();
    near_.locate(q);
    update();
    contact::assemble(scene(), active_, near_.y(), model_.point_map(), curvature, stencils_);
    return stencils_;
  }

  void max_step(Positions q, View<const Vec3> dq, device::EnvValues alpha) override {
    prepare();
    Buffer<Vec3> dy;
    near_.limit(q, dq, scene(), dy, alpha);
  }

  bool lag(Positions q) override {  // nothing is frozen here, but what is published must belong to q
    near_.locate(q);
    update();
    return false;
  }

  void end_step(Positions q) override {
    near_.locate(q);
    update();
  }

  void report(FieldSink& sink) override;

  // Supports are known only when all effects exist, so pairs are chosen at first use.
  void prepare() {
    if (near_.watching()) return;
    near_.watch(watched_pairs(model_, pairs_ ? &*pairs_ : nullptr));
    near_.locate(std::as_const(model_.q).view());
    weigh();
    update();
  }

 private:
  Scene scene() const { return near_.scene(law_, point_area_.view(), plane_area_.view()); }

  // Contact areas of the vertices as they stand at y.
  void weigh() {
    face_planes(scene(), near_.y(), plane_area_.view());
    point_area_.copy_from(model_.surface.vertex_area);
    build(scene(), near_.candidates(), near_.y(), model_.envs, active_);
    face_points(scene(), active_, near_.y(), point_area_.view());
  }

  // Active terms at y, and the samples that others see.
  void update() {
    build(scene(), near_.candidates(), near_.y(), model_.envs, active_);
    model::ContactView& view = model_.publish("barrier_contact");
    samples(scene(), active_, near_.y(), view.samples);
    view.env_offset = active_.env_offset;
  }

  model::Model& model_;
  Law law_;
  std::optional<Params> pairs_;
  Proximity near_;
  Buffer<double> point_area_, plane_area_;
  ActiveSet active_;
  linalg::StencilSet stencils_;
  bool checked_ = false;
};

void BarrierContact::report(FieldSink& sink) {
  prepare();
  const std::string group(name());
  const std::vector<Active> terms = active_.terms.download();
  Buffer<Vec3> buffer;
  point_forces(scene(), active_, near_.y(), buffer);
  const std::vector<Vec3> term_force = buffer.download();

  std::vector<double> area_of = point_area_.download();
  PointForces forces(model_, near_.points());
  SampleRows rows;
  const std::vector<model::ContactSample> samples = model_.publish(group).samples.download();
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const model::ContactSample& s = samples[i];
    if (terms[i].kind == TermKind::plane && law_.area_weighted) area_of[terms[i].point[0]] = terms[i].weight;
    for (int k = 0; k < 4; ++k) {
      if (terms[i].point[k] < 0) continue;
      const bool first = k == 0 || (k == 1 && terms[i].kind == TermKind::edge_edge);
      forces.add(terms[i].point[k], term_force[4 * i + k], first ? s.body_b : s.body_a);
    }
    rows.add(s);
  }
  forces.report(sink, group);
  std::vector<double> pressure(model_.points, 0.0);
  for (Index p = 0; p < model_.points; ++p)
    if (area_of[p] > 0) pressure[p] = forces.size(p) / area_of[p];
  sink.points("contact_pressure", "Pa", 1, pressure);

  rows.report(sink, group);
  sink.scalar(group, "pressure_sum_defect", "1", sum_defect(forces, {&rows}));
  sink.scalar(group, "min_distance", "m", std::min(law_.d_hat, least_distance(near_.obstacles(scene()), near_.candidates(), near_.y())));
  sink.scalar(group, "energy", "J", energy_now(std::as_const(model_.q).view(), model_.envs));
  sink.scalar(group, "active_pairs", "1", static_cast<double>(terms.size()));
}

}  // namespace

Kind barrier_contact_kind() {
  return {
      "barrier_contact",
      "bodies never touch: incremental potential contact with an area-weighted barrier",
      &kTable,
      [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<BarrierContact>(p, m); },
      {"Li, Ferguson, Schneider, Langlois, Zorin, Panozzo, Jiang, Kaufman: Incremental Potential Contact. ACM TOG 39(4), 2020",
       "Li, Kaufman, Jiang: Convergent Incremental Potential Contact. arXiv:2307.15908, 2023"},
      {"contact_force", "contact_pressure"}};
}

}  // namespace mortise::effects
