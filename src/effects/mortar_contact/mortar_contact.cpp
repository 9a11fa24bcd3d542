#include "effects/mortar_contact/mortar_contact.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "effects/body_blocks.h"
#include "effects/contact/join.h"
#include "effects/contact/layer.h"
#include "effects/contact/start_check.h"
#include "effects/list.h"
#include "effects/mortar_contact/moving.h"
#include "effects/mortar_contact/parameters.h"
#include "effects/per_environment.h"

namespace mortise::effects {
namespace mortar {
namespace {

std::vector<double> guard_ranges(double guard, const std::vector<double>& d_hat) {
  std::vector<double> out;
  for (double r : d_hat) out.push_back(std::max(guard, tuning::kLeastGuard) * r);
  return out;
}

}  // namespace

MortarContact::MortarContact(const Params& p, model::Model& model)
    : model_(model),
      set_(settings_of(p, model.faces.quarter.size() > 0)),
      d_hat_(contact::support_radii(p, model.input, model.envs)),
      guard_(p.number("guard")),
      rest_(p.number("rest_share")),
      surfaces_(p, model, d_hat_),
      stiffnesses_(p, model, surfaces_.interfaces()),
      proximity_(model, guard_ranges(guard_, d_hat_)) {
  std::vector<double> support;
  for (Index e = 0; e < model.envs; ++e) support.insert(support.end(), surfaces_.slave_env()[e + 1] - surfaces_.slave_env()[e], d_hat_[e]);
  support_.upload(support);
  margin_.upload(more_reach());
  stiffness_changed();
  model.add_contact(name());
}

std::vector<PlanItem> MortarContact::plan() const {
  return {{"candidate triangles", surfaces_.search().bytes()}, {"candidate pairs of the guard", proximity_.candidates().bytes()}};
}

void MortarContact::connect() {
  proximity_.watch(surfaces_.watched());
  fit_support();
}

// Pressures are those of gaps larger by the share: p(g) is a function of g / d_hat. Stiffnesses stay.
void MortarContact::mend(Fault fault, double share) {
  if (fault != Fault::gap) return;
  const double by = 1 / (1 + share);
  std::vector<double> support = support_.download();
  for (std::vector<double>* radii : {&support, &d_hat_})
    for (double& r : *radii) r *= by;
  support_.upload(support);
  surfaces_.scale_d_hat(by);
  proximity_.scale_reach(by);
  stiffness_changed();
}

void MortarContact::begin_step(const StepInfo& step) {
  if (stiffnesses_.begin_step(step)) stiffness_changed();
  proximity_.begin_step(step);
  if (started_) return;
  MortarLinearisation at(model_.envs);
  proximity_.locate(std::as_const(model_.q).view(), at.frozen.y);
  contact::check_start(model_, proximity_.obstacles(guard_view()), proximity_.candidates(), at.y());
  refreeze(at);
  check_faces(at);
  started_ = true;
}

// Quadratic faces must start apart as well, not their quarters only.
void MortarContact::check_faces(const MortarLinearisation& at) const {
  const Taken taken(at.frozen);
  for (const Sample& s : taken.samples) {
    const Pair& pair = taken.pairs[s.pair];
    if (!met(pair, s.gap)) continue;
    const Interface& between = surfaces_.interfaces()[pair.interface];
    throw Error(Exit::scene, model_.bodies[between.slave].where,
                "bodies must start apart: between their nodes, curved faces of '" + surfaces_.name_of(between.slave) + "' and '" +
                    surfaces_.name_of(between.master) + "' meet (leave a larger gap or use a finer mesh)");
  }
}

std::unique_ptr<Linearisation> MortarContact::linearisation() const { return std::make_unique<MortarLinearisation>(model_.envs); }

void MortarContact::linearise(Positions q, Want want, Linearisation& out) {
  MortarLinearisation& at = of_mortar(out);
  model_.points_of(q, at.frozen.y);
  take_samples(at, want.moving);
  if (!want.forces) return;
  if (guard_ > 0) contact::assemble(guard_view(), at.guard, at.y(), model_.point_map(), want.matrix, at.guard_stencils);
  mortar::assemble(view(at), at.frozen, model_.point_map(), want.matrix.wanted, at.guard_stencils, at.stencils);
  follow_samples(want.moving, at);
}

// Of the field and of the guard: the host waits once, as a rule.
void MortarContact::take_samples(MortarLinearisation& at, Moving moving) {
  const model::PointMapView map = model_.point_map();
  measure(at);
  surfaces_.search().work_on(model_.at_work);
  Freezing field;
  contact::TermSearch guard;
  contact::Candidates::Look near;
  device::Fetch fetch;
  field.begin(view(at), surfaces_.search(), margin_, rooms_, &map, at.frozen, fetch);
  if (guard_ > 0)
    guard.begin(guard_view(), where(at.frozen.y), room_, &map, at.guard, &at.guard_stencils, fetch);
  else
    proximity_.held().look(at.frozen.y, model_.at_work, near, fetch);
  fetch.now("mortar freeze");
  if (!field.end(rooms_, moving)) freeze(view(at), surfaces_.search(), margin_, rooms_, &map, moving, at.frozen);
  if (std::vector<std::uint8_t> finite; !(guard_ > 0)) {
    proximity_.held().settle(at.frozen.y, near, finite);
    at.guard_stencils.resize_uniform(0, 0);
  } else if (guard.end(room_)) {
    contact::shape(at.guard, at.guard_stencils);
  } else {
    contact::build(guard_view(), where(at.frozen.y), room_, map, at.guard, at.guard_stencils);
  }
}

void MortarContact::follow_samples(Moving wanted, MortarLinearisation& at) {
  at.unsymmetric.resize(0, 0);
  if (!wanted.wanted) return;
  mortar::samples(view(at), at.frozen, at.contact);
  mortar::sample_changes(view(at), at.frozen, at.contact.changes);
  mortar::follow(view(at), at.frozen, at.contact, model_.point_map(), at.beside, at.unsymmetric);
}

// Of the field and, where it acts, of the guard.
void MortarContact::sample(Linearisation& out) {
  MortarLinearisation& at = of_mortar(out);
  mortar::samples(view(at), at.frozen, at.contact);
  if (at.guard.terms.empty()) return;
  Buffer<model::ContactSample> more;
  contact::samples(guard_view(), at.guard, at.y(), more);
  contact::join(more, at.guard.env_offset, at.guard.sizes, at.contact, at.origin);
}

// Those of the field are there where they were asked for, the guard's always.
void MortarContact::sample_changes(Linearisation& out) {
  MortarLinearisation& at = of_mortar(out);
  if (!at.frozen.moving.any()) at.contact.changes.resize(0, 0);
  if (at.guard.terms.empty()) return;
  if (at.frozen.moving.any()) mortar::sample_changes(view(at), at.frozen, at.contact.changes);
  model::SampleChanges more;
  contact::sample_changes(guard_view(), at.guard, at.y(), more);
  contact::join(at.contact.samples, at.origin, more, at.contact.changes);
}

bool MortarContact::complete(const Linearisation& at) const { return mortar::complete(of_mortar(at).frozen); }

void MortarContact::energy(Positions q, const Linearisation& frozen, device::EnvValues per_env) {
  const MortarLinearisation& at = of_mortar(frozen);
  const auto y = std::make_shared<Buffer<Vec3>>();
  model_.points_of(q, *y);
  mortar::energy(view(at), at.frozen, std::as_const(*y).view(), model_.at_work, per_env);
  if (guard_ > 0)
    contact::energy(guard_view(), where(*y), per_env);
  else
    proximity_.require(*y, per_env);
  per_env.fetch.then([y] {});  // until then it stays
}

void MortarContact::max_step(View<const Vec3> dq, Linearisation& out, device::EnvValues alpha) {
  MortarLinearisation& at = of_mortar(out);
  const auto dy = proximity_.limit(at.frozen.y, dq, guard_view(), alpha);
  mortar::limit(view(at), at.frozen, dy->view(), contact::tuning::kKeep, alpha);
  at.farthest.assign(model_.envs, 0.0);
  const View<const Vec3> way = std::as_const(*dy).view();
  device::env_max(
      "mortar_contact.farthest", proximity_.point_env(), [=] MORTISE_HD(Index i) { return way[i].norm(); },
      device::EnvValues{at.farthest, alpha.fetch});
  alpha.fetch.then([&at, &value = alpha.value] { at.alpha = value; });
}

// Samples that the step may bring into range join the frozen ones, without any energy yet, so that the line search sees them.
void MortarContact::reach(Linearisation& out) {
  MortarLinearisation& at = of_mortar(out);
  bool any = false;
  std::vector<double> margin = more_reach();
  for (Index e = 0; e < model_.envs; ++e) {
    const double way = 2 * std::min(1.0, at.alpha[e]) * at.farthest[e];
    if (!std::isfinite(way) || way < tuning::kNearest * d_hat_[e]) continue;
    margin[e] += std::min(way, tuning::kFarthest * d_hat_[e]);
    any = true;
  }
  if (!any) return;
  surfaces_.search().work_on(model_.at_work);
  freeze(view(at), surfaces_.search(), Buffer<double>(margin), rooms_on_ways_, nullptr, false, at.frozen);
}

void MortarContact::adapt(const StepInfo& step, const std::vector<double>& budget, const Linearisation& at) {
  stiffnesses_.adapt(step, budget, of_mortar(at).frozen, [&] { return guard_energy(of_mortar(at)); });
}

void MortarContact::refit(Positions, const Linearisation& at, std::vector<Refit>& per_env) {
  if (stiffnesses_.refit(of_mortar(at).frozen, per_env)) stiffness_changed();
}

void MortarContact::checkpoint(Archive& archive) {
  stiffnesses_.checkpoint(archive);
  std::vector<double> support = support_.download();
  archive.io("support_radius", support, in_values(surfaces_.slave_env()));
  if (!archive.loading()) return;
  if (support.size() != static_cast<std::size_t>(support_.size()))
    throw Error(Exit::file, "the checkpoint belongs to another scene: it has " + std::to_string(support.size()) + " triangles that contact acts on");
  support_.upload(support);
  stiffness_changed();
  started_ = true;
}

std::vector<double> MortarContact::more_reach() const {
  std::vector<double> out;
  for (double d_hat : d_hat_) out.push_back(set_.averaged ? (tuning::kAverageReach - 1) * d_hat : 0);
  return out;
}

contact::Where MortarContact::where(const Buffer<Vec3>& y) { return {proximity_.held(), y, model_.at_work, model_.working(proximity_.vertex_env())}; }

MortarView MortarContact::view(const MortarLinearisation& at) const {
  geometry::SurfaceView surface = model_.surface.view();
  surface.pair_allowed = surfaces_.directed();
  return {set_,
          surface,
          proximity_.topology(),
          surfaces_.interface_at(),
          stiffnesses_.view(),
          surfaces_.d_hat(),
          proximity_.planes(),
          surfaces_.slaves(),
          support_.view(),
          at.normal.view(),
          at.area.view(),
          std::as_const(model_.faces.nodes).view(),
          std::as_const(model_.faces.quarter).view(),
          at.bow.view()};
}

contact::BarrierView MortarContact::guard_view() const {
  contact::BarrierParams barrier;
  barrier.area_weighted = false;
  return proximity_.view(barrier, guard_kappa_, {}, {});
}

void MortarContact::stiffness_changed() {
  std::vector<double> kappa = stiffnesses_.of_guard();
  for (Index e = 0; e < model_.envs; ++e) kappa[e] /= proximity_.reach(e) * proximity_.reach(e);
  guard_kappa_.upload(kappa);
}

void MortarContact::measure(MortarLinearisation& at) const {
  mortar::measure(model_.surface.view(), model_.faces, at.y(), model_.working(surfaces_.triangle_env()), at.normal, at.area, at.bow);
}

// Samples within range at y.
void MortarContact::refreeze(MortarLinearisation& at) {
  measure(at);
  surfaces_.search().work_on(model_.at_work);
  freeze(view(at), surfaces_.search(), margin_, rooms_, nullptr, false, at.frozen);
}

// From the state at the start.
void MortarContact::fit_support() {
  if (!(rest_ > 0)) return;
  MortarLinearisation at(model_.envs);
  proximity_.locate(std::as_const(model_.q).view(), at.frozen.y);
  refreeze(at);
  Buffer<double> least;
  least_gaps(view(at), surfaces_.search(), at.y(), least);
  std::vector<double> support = least.download();
  for (Index e = 0; e < model_.envs; ++e)
    for (Index t = surfaces_.slave_env()[e]; t < surfaces_.slave_env()[e + 1]; ++t)
      support[t] = std::clamp(rest_ * support[t], tuning::kLeastSupport * d_hat_[e], d_hat_[e]);
  support_.upload(support);
}

// Per environment [J].
std::vector<double> MortarContact::guard_energy(const MortarLinearisation& at) {
  std::vector<double> per_env(model_.envs, 0.0);
  if (!(guard_ > 0)) return per_env;
  device::Fetch fetch;
  contact::energy(guard_view(), where(at.frozen.y), {per_env, fetch});
  fetch.now("energies");
  return per_env;
}

}  // namespace mortar

const Kind& mortar_contact_kind() {
  static const Kind kind =
      Kind{"mortar_contact",
           Role::contact,
           "contact pressure as a field: barrier over the exact overlap of two surfaces (GMCP)",
           &mortar::parameters(),
           [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<mortar::MortarContact>(p, m); },
           {"Liang, Han: IsaacIPC (geometric mortar contact potential). arXiv:2605.24339, 2026",
            "Puso, Laursen: A mortar segment-to-segment contact method for large deformation solid mechanics. CMAME 193, 2004",
            "Li, Kaufman, Jiang: Convergent Incremental Potential Contact. arXiv:2307.15908, 2023"},
           {"contact_force", "contact_pressure", "contact_area"},
           {},
           false}
          .differing_in({"d_hat", "stiffness"});  // samples are frozen (frozen.h)
  return kind;
}

const Kind& mortar::MortarContact::kind() const { return mortar_contact_kind(); }

}  // namespace mortise::effects
