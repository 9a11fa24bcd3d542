#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include "base/error.h"
#include "effects/contact/active.h"
#include "effects/contact/layer.h"
#include "effects/contact/nodal_pressure.h"
#include "effects/contact/proximity.h"
#include "effects/contact/report.h"
#include "effects/contact/start_check.h"
#include "effects/list.h"
#include "effects/per_environment.h"

namespace mortise::effects {
namespace {

using namespace contact;

const ParamTable kTable{
    "effect barrier_contact",
    "Bodies never touch: a barrier acts between surfaces nearer than d_hat (incremental potential contact).",
    {support_radius_param("Distance at which contact begins to act"),
     param::positive(param::automatic(
         param::number("stiffness", Unit::pressure, "1 MPa", 0,
                       "Pressure scale kappa: two flat surfaces press with kappa phi(gap/d_hat), which is kappa at "
                       "0.53 d_hat and 4.3 kappa at d_hat/4; auto, or without it, the bodies' largest E*, 1 MPa where all are stiff"))),
     param::choice("form", {"area_weighted", "classic"}, "area_weighted",
                   "area_weighted: pressures do not depend on the mesh; classic: every pair of primitives has the weight d_hat^2 "
                   "(stiffness kappa d_hat in N/m)"),
     param::optional(param::of(Param::Kind::pairs, "pairs", Unit::none, {}, "Pairs of bodies in contact; without it, all pairs"))}};

struct BarrierLinearisation final : Linearisation {
  Buffer<Vec3> y;
  ActiveSet active;
  std::vector<std::uint8_t> whose;  // the environments of which it has terms, as in model::Model::at_work
  // Terms at a state where forces may be asked for next, of the environments of `whose`.
  struct Ahead {
    Buffer<Vec3> y;
    ActiveSet active;
    linalg::StencilSet shape;
    std::vector<std::uint8_t> whose;
    bool there = false;
  } ahead;
  std::size_t bytes() const override {
    return Linearisation::bytes() + y.bytes() + active.terms.bytes() + ahead.y.bytes() + ahead.active.terms.bytes() + ahead.shape.bytes();
  }
};
BarrierLinearisation& of_barrier(Linearisation& at) { return static_cast<BarrierLinearisation&>(at); }
const BarrierLinearisation& of_barrier(const Linearisation& at) { return static_cast<const BarrierLinearisation&>(at); }

class BarrierContact final : public Effect {
 public:
  BarrierContact(const Params& p, model::Model& model) : model_(model), proximity_(model, support_radii(p, model.input, model.envs)) {
    std::vector<double> kappa;
    for (Index e = 0; e < model.envs; ++e) kappa.push_back(stiffness(model.input.effect_of(p, e), model.input, e));
    kappa_.upload(kappa);
    barrier_.area_weighted = p.text("form") == "area_weighted";
    barrier_.edge_share = barrier_.area_weighted ? contact::tuning::kEdgeRange : 1;
    if (const Params* list = p.find("pairs")) pairs_ = *list;
    plane_area_.resize(static_cast<Index>(model.half_spaces.size()) * model.surface.vertices.size());
    model.add_contact(name());
  }

  const Kind& kind() const override;
  std::vector<PlanItem> plan() const override {
    return {{"areas of points", point_area_.bytes() + plane_area_.bytes()}, {"candidate pairs", proximity_.candidates().bytes()}};
  }

  void connect() override {
    proximity_.watch(watched_pairs(model_, pairs_ ? &*pairs_ : nullptr));
    weigh({});
  }

  // Pressures are those of gaps larger by the share: p(g) is a function of g / d_hat.
  void mend(Fault fault, double share) override {
    if (fault != Fault::gap) return;
    proximity_.scale_reach(1 / (1 + share));
    if (barrier_.area_weighted) return;
    std::vector<double> kappa = kappa_.download();  // the classic form weighs with the square of d_hat
    for (double& k : kappa) k *= (1 + share) * (1 + share);
    kappa_.upload(kappa);
  }

  void begin_step(const StepInfo& step) override {
    proximity_.begin_step(step);
    weigh(step);
    if (!checked_) check_start(model_, proximity_.obstacles(view()), proximity_.candidates(), std::as_const(y_).view());
    checked_ = true;
  }

  std::unique_ptr<Linearisation> linearisation() const override { return std::make_unique<BarrierLinearisation>(); }

  void linearise(Positions q, Want want, Linearisation& out) override {
    BarrierLinearisation& at = of_barrier(out);
    if (std::exchange(at.ahead.there, false) && want.foreseen && at.ahead.whose == model_.at_work) {
      at.y.swap(at.ahead.y);
      std::swap(at.active, at.ahead.active);
      at.stencils.take_shape(at.ahead.shape);
      shape(at.active, at.stencils);
    } else if (!want.here || at.whose != model_.at_work) {
      model_.points_of(q, at.y);
      build(view(), where(at.y), room_, model_.point_map(), at.active, at.stencils);
    }
    at.whose = model_.at_work;
    if (want.forces) contact::assemble(view(), at.active, std::as_const(at.y).view(), model_.point_map(), want.matrix, at.stencils);
  }

  void foresee(Positions q, Linearisation& out, device::Fetch& fetch) override {
    BarrierLinearisation::Ahead& ahead = of_barrier(out).ahead;
    ahead.there = false, ahead.whose = model_.at_work;
    model_.points_of(q, ahead.y);
    const model::PointMapView map = model_.point_map();
    const auto search = std::make_shared<TermSearch>();
    search->begin(view(), where(ahead.y), room_, &map, ahead.active, &ahead.shape, fetch);
    fetch.then([this, search, &ahead] { ahead.there = search->end(room_); });
  }

  void sample(Linearisation& out) override {
    BarrierLinearisation& at = of_barrier(out);
    samples(view(), at.active, std::as_const(at.y).view(), at.contact.samples);
    at.contact.env_offset = at.active.env_offset;
    at.contact.sizes = at.active.sizes;
  }

  void sample_changes(Linearisation& out) override {
    BarrierLinearisation& at = of_barrier(out);
    contact::sample_changes(view(), at.active, std::as_const(at.y).view(), at.contact.changes);
  }

  void energy(Positions q, const Linearisation&, device::EnvValues per_env) override {
    const auto y = std::make_shared<Buffer<Vec3>>();
    model_.points_of(q, *y);
    contact::energy(view(), where(*y), per_env);
    per_env.fetch.then([y] {});  // until then it stays
  }

  void max_step(View<const Vec3> dq, Linearisation& at, device::EnvValues alpha) override { proximity_.limit(of_barrier(at).y, dq, view(), alpha); }

  void report(const FieldSinks& sinks, const Linearisation& at) override;

  void checkpoint(Archive& archive) override {
    if (!archive.loading()) return;
    StepInfo loaded;
    for (Index e = 0; e < model_.envs; ++e) loaded.whose.push_back(archive.loads(e));
    weigh(loaded);  // the positions have been read already
  }

 private:
  Where where(const Buffer<Vec3>& y) { return {proximity_.held(), y, model_.at_work, model_.working(proximity_.vertex_env())}; }
  BarrierView view() const { return proximity_.view(barrier_, kappa_, point_area_.view(), plane_area_.view()); }

  // Contact areas of the vertices of environments that take the step, as they stand at the accepted state.
  void weigh(const StepInfo& step) {
    Buffer<double> old_points, old_planes;
    if (!step.whose.empty()) old_points.copy_from(point_area_), old_planes.copy_from(plane_area_);
    model_.points_of(std::as_const(model_.q).view(), y_);
    const View<const Vec3> y = std::as_const(y_).view();
    face_planes(view(), y, plane_area_.view());
    point_area_.copy_from(model_.surface.vertex_area);
    ActiveSet active;
    build(view(), where(y_), room_, active);
    face_points(view(), active, y, point_area_.view());
    const auto keep = [](const Buffer<double>& from, Index begin, Index end, Buffer<double>& to) {
      if (end > begin) device::copy(to.view().p + begin, from.view().p + begin, static_cast<std::size_t>(end - begin) * sizeof(double));
    };
    const Index planes = static_cast<Index>(model_.half_spaces.size()), vertices = model_.surface.vertices.size();
    for (Index e = 0; e < model_.envs; ++e) {
      if (step.taken_by(e)) continue;
      keep(old_points, proximity_.point_env()[e], proximity_.point_env()[e + 1], point_area_);
      for (Index p = 0; p < planes; ++p)
        keep(old_planes, p * vertices + proximity_.vertex_env()[e], p * vertices + proximity_.vertex_env()[e + 1], plane_area_);
    }
  }

  model::Model& model_;
  BarrierParams barrier_;
  Buffer<double> kappa_;  // per environment [Pa]
  std::optional<Params> pairs_;
  Proximity proximity_;
  TermRoom room_;
  Buffer<double> point_area_, plane_area_;  // in this step
  Buffer<Vec3> y_;                          // work space
  bool checked_ = false;
};

void BarrierContact::report(const FieldSinks& sinks, const Linearisation& accepted) {
  const BarrierLinearisation& at = of_barrier(accepted);
  const std::string group(name());
  const std::vector<Active> terms = at.active.terms.download();
  Buffer<Vec3> buffer;
  point_forces(view(), at.active, at.y.view(), buffer);
  const std::vector<Vec3> term_force = buffer.download();

  PointForces forces(model_, at.y);
  std::vector<SampleRows> rows;
  for (Index e = 0; e < model_.envs; ++e) rows.emplace_back(model_, e);
  const std::vector<model::ContactSample> samples = at.contact.samples.download();
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const model::ContactSample& s = samples[i];
    for (int k = 0; k < 4; ++k) {
      if (terms[i].point[k] < 0) continue;
      const bool first = k == 0 || (k == 1 && terms[i].kind == TermKind::edge_edge);
      forces.add(terms[i].point[k], term_force[4 * i + k], first ? s.body_b : s.body_a);
    }
    rows[s.env].add(s);
  }
  forces.report(sinks, group);
  const NodalPressure nodal = nodal_pressure(model_.surface, forces.places(), forces.force());
  report_points(sinks, model_, "contact_pressure", "Pa", 1, nodal.pressure);
  report_points(sinks, model_, "contact_area", "m^2", 1, nodal.area);

  const std::vector<double> distance =
                                least_distances(proximity_.obstacles(view()), proximity_.candidates(at.y), at.y.view(), proximity_.vertex_env()),
                            energy = energies_now(std::as_const(model_.q).view(), at, model_.envs);
  for (Index e = 0; e < sinks.size(); ++e) {
    rows[e].report(sinks[e], group);
    sinks[e].scalar(group, "pressure_sum_defect", "1", sum_defect(forces, {&rows[e]}));
    sinks[e].scalar(group, "min_distance", "m", std::min(proximity_.reach(e), distance[e]));
    sinks[e].scalar(group, "energy", "J", energy[e]);
    sinks[e].scalar(group, "active_pairs", "1", static_cast<double>(at.active.env_offset[e + 1] - at.active.env_offset[e]));
  }
}

}  // namespace

const Kind& barrier_contact_kind() {
  static const Kind kind = Kind{
      "barrier_contact",
      Role::contact,
      "bodies never touch: incremental potential contact with an area-weighted barrier",
      &kTable,
      [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<BarrierContact>(p, m); },
      {"Li, Ferguson, Schneider, Langlois, Zorin, Panozzo, Jiang, Kaufman: Incremental Potential Contact. ACM TOG 39(4), 2020",
       "Li, Kaufman, Jiang: Convergent Incremental Potential Contact. arXiv:2307.15908, 2023"},
      {"contact_force", "contact_pressure",
       "contact_area"}}.differing_in({"d_hat", "stiffness"});
  return kind;
}

const Kind& BarrierContact::kind() const { return barrier_contact_kind(); }

}  // namespace mortise::effects
