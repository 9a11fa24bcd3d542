#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/error.h"
#include "effects/contact/active.h"
#include "effects/barrier_contact/pairs.h"
#include "effects/contact/start_check.h"
#include "effects/list.h"
#include "geometry/collide/step_limit.h"

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

// Share of every distance that a step may not use up.
constexpr double kKeep = 0.1;

// First surface vertex, or first point, of every environment.
std::vector<Index> offsets_by_env(const std::vector<Index>& env, Index envs) {
  std::vector<Index> offset(envs + 1, 0);
  for (Index e : env) ++offset[e + 1];
  for (Index e = 0; e < envs; ++e) offset[e + 1] += offset[e];
  return offset;
}

class BarrierContact final : public Effect {
 public:
  BarrierContact(const Params& p, model::Model& model)
      : model_(model),
        topology_(model.surface, model.points),
        candidates_(model.broadphase(), p.number("d_hat"), offsets_by_env(model.surface.env.download(), model.envs)) {
    law_.d_hat = p.number("d_hat");
    law_.kappa = p.number("stiffness");
    law_.area_weighted = p.text("form") == "area_weighted";
    law_.edge_range = law_.area_weighted ? kEdgeShare * law_.d_hat : law_.d_hat;
    if (const Params* list = p.find("pairs")) pairs_ = *list;
    const std::vector<Index> env = model.surface.env.download();
    std::vector<Index> vertex_env;
    for (Index v : model.surface.vertices.download()) vertex_env.push_back(env[v]);
    vertex_env_ = offsets_by_env(vertex_env, model.envs);
    std::vector<Plane> planes;
    for (const model::HalfSpace& h : model.half_spaces) planes.push_back({h.point, h.normal});
    planes_.upload(planes);
    plane_area_.resize(planes_.size() * model.surface.vertices.size());
    model.publish(std::string(name()));
  }

  std::string_view name() const override { return "barrier_contact"; }

  void plan(Plan& out) const override {
    out.buffers.push_back({"stencils", stencils_.bytes()});
    out.buffers.push_back({"active terms", active_.terms.bytes()});
    out.buffers.push_back({"candidate pairs", candidates_.bytes()});
    for (const char* k :
         {"contact.near", "contact.terms", "contact.merge", "contact.point_terms",
          "contact.edge_terms", "contact.count_blocks", "contact.assemble", "contact.samples",
          "contact.energy_points", "contact.energy_edges", "contact.face_points"})
      out.kernels.push_back(k);
    if (!model_.half_spaces.empty())
      for (const char* k : {"contact.face_planes", "contact.near_planes", "contact.plane_terms",
                            "contact.energy_planes", "contact.limit_planes"})
        out.kernels.push_back(k);
  }

  void begin_step(const StepInfo&) override {
    prepare();
    locate(std::as_const(model_.q).view());
    if (!checked_) check_start(model_, scene(), candidates_, y());
    checked_ = true;
    weigh();
    update();
  }

  void energy(Positions q, std::vector<double>& per_env) override {
    prepare();
    const std::vector<std::uint8_t> finite = locate(q);
    contact::energy(scene(), candidates_, y(), vertex_env_, per_env);
    for (std::size_t e = 0; e < per_env.size(); ++e)
      if (!finite[e] || std::isnan(per_env[e])) per_env[e] = INFINITY;
  }

  linalg::StencilSet& assemble(Positions q, bool hessian) override {
    prepare();
    locate(q);
    update();
    contact::assemble(scene(), active_, y(), model_.point_map(), hessian, stencils_);
    return stencils_;
  }

  void max_step(Positions q, View<const Vec3> dq, std::vector<double>& alpha) override {
    prepare();
    Buffer<Vec3> dy;
    model_.points_of(q, y_);
    model_.points_of(dq, dy);
    candidates_.sweep(y_, dy);
    geometry::limit_step(candidates_.broadphase(), y(), dy.view(), kKeep, alpha);
    limit_planes(scene(), y(), dy.view(), kKeep, vertex_env_, alpha);
  }

  bool lag(Positions q) override {  // nothing is frozen here, but what is published must belong to q
    locate(q);
    update();
    return false;
  }

  void end_step(Positions q) override {
    locate(q);
    update();
  }

  void report(FieldSink& sink) override;

  // Supports are known only when all effects exist, so pairs are chosen at first use.
  void prepare() {
    if (watched_.size() > 0) return;
    const WatchedPairs w = watched_pairs(model_, pairs_ ? &*pairs_ : nullptr);
    const Index n = static_cast<Index>(model_.bodies.size());
    for (Index a = 0; a < n; ++a)
      for (Index b = a; b < n; ++b)
        if (w.bodies[a * n + b]) model_.watch(a, b, true);
    watched_.upload(w.bodies);
    plane_watched_.upload(w.planes);
    locate(std::as_const(model_.q).view());
    weigh();
  }

 private:
  Scene scene() const {
    return {law_,
            model_.surface.view(),
            topology_.view(),
            std::as_const(model_.rest_points).view(),
            watched_.view(),
            plane_watched_.view(),
            planes_.view(),
            point_area_.view(),
            plane_area_.view()};
  }
  View<const Vec3> y() const { return y_.view(); }

  // y = W q, with all its candidates; tells which environments have finite positions.
  std::vector<std::uint8_t> locate(Positions q) {
    std::vector<std::uint8_t> finite;
    model_.points_of(q, y_);
    candidates_.cover(y_, finite);
    return finite;
  }

  // Contact areas of the vertices as they stand at y.
  void weigh() {
    face_planes(scene(), y(), plane_area_.view());
    point_area_.copy_from(model_.surface.vertex_area);
    build(scene(), candidates_, y(), model_.envs, active_);
    face_points(scene(), active_, y(), point_area_.view());
  }

  // Active terms at y, and the samples that others see.
  void update() {
    build(scene(), candidates_, y(), model_.envs, active_);
    model::ContactView& view = model_.publish("barrier_contact");
    samples(scene(), active_, y(), view.samples);
    view.env_offset = active_.env_offset;
  }

  model::Model& model_;
  Law law_;
  std::optional<Params> pairs_;
  Topology topology_;
  Candidates candidates_;
  std::vector<Index> vertex_env_;
  Buffer<std::uint8_t> watched_, plane_watched_;
  Buffer<Plane> planes_;
  Buffer<double> point_area_, plane_area_;
  Buffer<Vec3> y_;
  ActiveSet active_;
  linalg::StencilSet stencils_;
  bool checked_ = false;
};

void BarrierContact::report(FieldSink& sink) {
  prepare();
  const std::vector<model::ContactSample> view = model_.publish("barrier_contact").samples.download();
  const std::vector<Active> terms = active_.terms.download();
  const std::vector<Index> body = model_.surface.body.download();
  std::vector<double> area_of = point_area_.download();
  Buffer<Vec3> buffer;
  point_forces(scene(), active_, y(), buffer);
  const std::vector<Vec3> term_force = buffer.download();

  std::vector<double> force(3 * model_.points, 0.0), pressure(model_.points, 0.0);
  std::vector<Vec3> resultant(model_.bodies.size(), Vec3::Zero());
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (terms[i].kind == TermKind::plane && law_.area_weighted) area_of[terms[i].point[0]] = terms[i].weight;
    for (int k = 0; k < 4; ++k) {
      const Index p = terms[i].point[k];
      if (p < 0) continue;
      for (int c = 0; c < 3; ++c) force[3 * p + c] += term_force[4 * i + k][c];
      resultant[body[p]] += term_force[4 * i + k];
    }
  }
  for (Index p = 0; p < model_.points; ++p)
    if (area_of[p] > 0) pressure[p] = std::hypot(force[3 * p], force[3 * p + 1], force[3 * p + 2]) / area_of[p];
  sink.points("contact_force", "N", 3, force);
  sink.points("contact_pressure", "Pa", 1, pressure);

  std::vector<double> position, normal, magnitude, area, gap, sample_pressure, bodies;
  double closest = law_.d_hat;
  for (const model::ContactSample& s : view) {
    position.insert(position.end(), s.position, s.position + 3);
    normal.insert(normal.end(), s.normal, s.normal + 3);
    magnitude.push_back(s.force), area.push_back(s.area), gap.push_back(s.gap), sample_pressure.push_back(s.pressure);
    bodies.push_back(s.body_a), bodies.push_back(s.body_b);
    closest = std::min(closest, s.gap);
  }
  const std::string group(name());
  sink.rows(group, "position", "m", 3, position);
  sink.rows(group, "normal", "1", 3, normal);
  sink.rows(group, "force", "N", 1, magnitude);
  sink.rows(group, "area", "m^2", 1, area);
  sink.rows(group, "gap", "m", 1, gap);
  sink.rows(group, "pressure", "Pa", 1, sample_pressure);
  sink.rows(group, "bodies", "1", 2, bodies);
  sink.scalar(group, "min_distance", "m", closest);
  std::vector<double> stored(model_.envs, 0.0);
  energy(std::as_const(model_.q).view(), stored);
  sink.scalar(group, "energy", "J", std::accumulate(stored.begin(), stored.end(), 0.0));
  sink.scalar(group, "active_pairs", "1", static_cast<double>(terms.size()));
  for (std::size_t b = 0; b < model_.bodies.size(); ++b)
    for (int c = 0; c < 3; ++c) sink.scalar(group, "force_" + model_.bodies[b].name + "_" + "xyz"[c], "N", resultant[b][c]);
}

}  // namespace

Kind barrier_contact_kind() {
  return {
      "barrier_contact",
      "bodies never touch: incremental potential contact with an area-weighted barrier",
      &kTable,
      [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<BarrierContact>(p, m); },
      {"Li, Ferguson, Schneider, Langlois, Zorin, Panozzo, Jiang, Kaufman: Incremental Potential Contact. ACM TOG 39(4), 2020",
       "Li, Kaufman, Jiang: Convergent Incremental Potential Contact. arXiv:2307.15908, 2023"}};
}

}  // namespace mortise::effects
