#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "base/error.h"
#include "effects/body_blocks.h"
#include "effects/contact/active.h"
#include "effects/contact/join.h"
#include "effects/contact/layer.h"
#include "effects/contact/nodal_pressure.h"
#include "effects/contact/proximity.h"
#include "effects/contact/report.h"
#include "effects/contact/start_check.h"
#include "effects/list.h"
#include "effects/mortar_contact/averaged.h"
#include "effects/mortar_contact/freezing.h"
#include "effects/mortar_contact/moving.h"
#include "effects/mortar_contact/stiffness.h"
#include "effects/per_environment.h"

namespace mortise::effects {
namespace {

using namespace mortar;

const ParamTable kPair{
    "contact pair of mortar_contact",
    "Which surface carries the samples and which one they see.",
    {param::of(Param::Kind::text, "slave", Unit::none, std::nullopt, "Body whose surface is integrated over: the finer, the softer, the sensor"),
     param::of(Param::Kind::text, "master", Unit::none, std::nullopt, "Body or half-space that presses on it")}};

Param pair_list() {
  Param p = param::required(param::table("pairs", &kPair, "Surfaces in contact"));
  p.kind = Param::Kind::tables;
  return p;
}

const ParamTable kTable{
    "effect mortar_contact",
    "Contact pressure as a field: a barrier integrated over the exact overlap of two surfaces (geometric mortar contact "
    "potential).",
    {pair_list(), contact::support_radius_param("Gap at which contact begins to act"),
     param::positive(
         param::automatic(param::number("stiffness", Unit::pressure, "1 MPa", 0,
                                        "Pressure scale kappa: the pressure is kappa phi(gap/d_hat); auto, or without it, the bodies' E* "
                                        "where d_hat is left open too, else chosen so that the layer is four times as stiff as the mesh"))),
     param::choice("weights", {"consistent", "tapered"}, "consistent",
                   "consistent: exact overlap, passes the patch test, with edge and point samples where surfaces are not "
                   "parallel; tapered: the published form"),
     param::positive(param::range(
         param::number("taper_width", Unit::none, "0.1", 0, "Width of the taper of tapered weights, in barycentric coordinates of the master"), 0,
         1.0 / 3)),
     param::choice("quadrature", {"1", "3", "6", "7", "exact"}, "3",
                   "Gauss points per piece of overlap; exact: along lines of equal gap, as many as the barrier asks for"),
     param::choice("gap", {"pointwise", "averaged"}, "pointwise",
                   "pointwise: every sample has its barrier; averaged: every slave node has one, over the mean gap around it, which "
                   "keeps pressures smooth however large the stiffness is"),
     param::choice("gradient", {"frozen", "exact"}, "frozen",
                   "frozen: forces along the slave normal (published form); exact: also the turning of the normal, forces along "
                   "the master normal"),
     param::range(param::number("guard", Unit::none, "0.2", 0,
                                "Share of d_hat within which a barrier between points, edges and triangles acts as well; 0: none"),
                  0, 1),
     param::range(param::number("rest_share", Unit::none, "0", 0,
                                "d_hat is reduced to this share of the gap at the start, triangle by triangle, so that nothing "
                                "presses at the start (1); 0: it is not"),
                  0, 1),
     param::of(Param::Kind::flag, "two_pass", Unit::none, "false", "Both surfaces of every pair are slaves, with half of the weight")}};

struct MortarLinearisation final : Linearisation {
  FrozenSamples frozen;
  Buffer<Vec3> normal;       // of all triangles there,
  Buffer<double> area, bow;  // their areas, and how far their quadratic faces stand off
  contact::ActiveSet guard;
  linalg::StencilSet guard_stencils;
  Buffer<Index> origin;                 // of contact.samples, where the guard has some (contact/join.h)
  std::vector<double> alpha, farthest;  // of the way that was asked for last: as far as it may be gone; how far it moves points [m]
  explicit MortarLinearisation(Index envs) { guard.env_offset.assign(envs + 1, 0); }
  // Places of sample i of the field and of the guard in contact.samples: in every environment those of the guard come last.
  Index place(Index env, Index i) const { return i + guard.env_offset[env]; }
  Index guard_place(Index env, Index i) const { return i + frozen.env_samples[env + 1]; }
  View<const Vec3> y() const { return frozen.y.view(); }
  std::size_t bytes() const override {
    return Linearisation::bytes() + frozen.pairs.bytes() + frozen.samples.bytes() + frozen.moving.bytes() + frozen.y.bytes() + normal.bytes() +
           area.bytes() + guard.terms.bytes() + guard_stencils.bytes() + origin.bytes();
  }
};
MortarLinearisation& of_mortar(Linearisation& at) { return static_cast<MortarLinearisation&>(at); }
const MortarLinearisation& of_mortar(const Linearisation& at) { return static_cast<const MortarLinearisation&>(at); }

class MortarContact final : public Effect {
 public:
  MortarContact(const Params& p, model::Model& model)
      : model_(model),
        d_hat_(contact::support_radii(p, model.input, model.envs)),
        guard_(p.number("guard")),
        rest_(p.number("rest_share")),
        proximity_(model, guard_ranges()) {
    set_.taper = p.text("weights") == "tapered" ? p.number("taper_width") : 0;
    set_.quadrature = p.text("quadrature") == "exact" ? kExact : std::stoi(p.text("quadrature"));
    set_.exact = p.text("gradient") == "exact";
    set_.averaged = p.text("gap") == "averaged";
    if (set_.averaged && (rest_ > 0 || model.faces.quarter.size() > 0))
      throw Error(Exit::scene, p.at("gap").where(), "averaged gaps need linear tetrahedra and no rest_share");
    set_.pass_weight = p.flag("two_pass") ? 0.5 : 1;
    choose_pairs(p.at("pairs"), p.flag("two_pass"));
    choose_slaves();
    margin_.upload(more_reach());
    if (set_.quadrature == 1 && model.faces.quarter.size() > 0)
      throw Error(Exit::scene, p.at("quadrature").where(), "one point per piece is not enough for the shape functions of quadratic faces: 3, 6 or 7");
    automatic_ = !p.has("stiffness");
    std::vector<double> d_hats;
    for (Interface& i : interfaces_) {
      i.fixed = !p.has("d_hat") && i.modulus > 0;
      const Index e = model.bodies[i.slave].env;
      d_hats.push_back(d_hat_[e]);
      kappa_.push_back(automatic_ ? first_stiffness(i, d_hat_[e]) : model.input.effect_of(p, e).number("stiffness"));
    }
    d_hat_view_.upload(d_hats);
    next_kappa_ = kappa_;
    next_price_.assign(model.envs, 0.0);
    stiffness_changed();
    model.add_contact(name());
  }

  const Kind& kind() const override;

  std::vector<PlanItem> plan() const override {
    return {{"candidate triangles", search_.bytes()}, {"candidate pairs of the guard", proximity_.candidates().bytes()}};
  }

  void connect() override {
    watch();
    fit_support();
  }

  // Pressures are those of gaps larger by the share: p(g) is a function of g / d_hat. Stiffnesses stay.
  void mend(Fault fault, double share) override {
    if (fault != Fault::gap) return;
    const double by = 1 / (1 + share);
    std::vector<double> support = support_.download(), d_hat = d_hat_view_.download();
    for (std::vector<double>* radii : {&support, &d_hat, &d_hat_})
      for (double& r : *radii) r *= by;
    support_.upload(support), d_hat_view_.upload(d_hat);
    proximity_.scale_reach(by);
    stiffness_changed();
  }

  void begin_step(const StepInfo& step) override {
    static_ = step.is_static;
    bool changed = false;
    for (std::size_t i = 0; i < kappa_.size(); ++i) {
      if (!step.taken_by(env(i)) || kappa_[i] == next_kappa_[i]) continue;
      kappa_[i] = next_kappa_[i];
      changed = true;
    }
    if (changed) stiffness_changed();
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
  void check_faces(const MortarLinearisation& at) {
    const std::vector<Pair> pairs = at.frozen.pairs.download();
    for (const Sample& s : at.frozen.samples.download()) {
      const Pair& pair = pairs[s.pair];
      if (!met(pair, s.gap)) continue;
      const std::vector<Index> body = model_.surface.body.download();
      const model::Body& slave = model_.bodies[body[pair.on.point[0]]];
      const std::string& master = pair.master < 0 ? model_.half_spaces[-1 - pair.master].name : model_.bodies[body[pair.under.point[0]]].name;
      throw Error(Exit::scene, slave.where,
                  "bodies must start apart: between their nodes, curved faces of '" + slave.name + "' and '" + master +
                      "' meet (leave a larger gap or use a finer mesh)");
    }
  }

  std::unique_ptr<Linearisation> linearisation() const override { return std::make_unique<MortarLinearisation>(model_.envs); }

  void linearise(Positions q, Want want, Linearisation& out) override {
    MortarLinearisation& at = of_mortar(out);
    model_.points_of(q, at.frozen.y);
    take_samples(at, want.moving);
    if (!want.forces) return;
    if (guard_ > 0) contact::assemble(guard_view(), at.guard, at.y(), model_.point_map(), want.matrix, at.guard_stencils);
    mortar::assemble(view(at), at.frozen, model_.point_map(), want.matrix.wanted, at.guard_stencils, at.stencils);
    follow(want.moving, at);
  }
  // Of the field and of the guard: the host waits once, as a rule.
  void take_samples(MortarLinearisation& at, Moving moving) {
    const model::PointMapView map = model_.point_map();
    measure(at);
    search_.work_on(model_.at_work);
    Freezing field;
    contact::TermSearch guard;
    contact::Candidates::Look near;
    device::Fetch fetch;
    field.begin(view(at), search_, margin_, rooms_, &map, at.frozen, fetch);
    if (guard_ > 0)
      guard.begin(guard_view(), where(at.frozen.y), room_, &map, at.guard, &at.guard_stencils, fetch);
    else
      proximity_.held().look(at.frozen.y, model_.at_work, near, fetch);
    fetch.now("mortar freeze");
    if (!field.end(rooms_, moving)) freeze(view(at), search_, margin_, rooms_, &map, moving, at.frozen);
    if (std::vector<std::uint8_t> finite; !(guard_ > 0)) {
      proximity_.held().settle(at.frozen.y, near, finite);
      at.guard_stencils.resize_uniform(0, 0);
    } else if (guard.end(room_)) {
      contact::shape(at.guard, at.guard_stencils);
    } else {
      contact::build(guard_view(), where(at.frozen.y), room_, map, at.guard, at.guard_stencils);
    }
  }
  void follow(Moving wanted, MortarLinearisation& at) {
    at.unsymmetric.resize(0, 0);
    if (!wanted.wanted) return;
    mortar::samples(view(at), at.frozen, at.contact);
    mortar::sample_changes(view(at), at.frozen, at.contact.changes);
    mortar::follow(view(at), at.frozen, at.contact, model_.point_map(), at.beside, at.unsymmetric);
  }

  // Of the field and, where it acts, of the guard.
  void sample(Linearisation& out) override {
    MortarLinearisation& at = of_mortar(out);
    mortar::samples(view(at), at.frozen, at.contact);
    if (at.guard.terms.empty()) return;
    Buffer<model::ContactSample> more;
    contact::samples(guard_view(), at.guard, at.y(), more);
    contact::join(more, at.guard.env_offset, at.guard.sizes, at.contact, at.origin);
  }
  // Those of the field are there where they were asked for, the guard's always.
  void sample_changes(Linearisation& out) override {
    MortarLinearisation& at = of_mortar(out);
    if (!at.frozen.moving.any()) at.contact.changes.resize(0, 0);
    if (at.guard.terms.empty()) return;
    if (at.frozen.moving.any()) mortar::sample_changes(view(at), at.frozen, at.contact.changes);
    model::SampleChanges more;
    contact::sample_changes(guard_view(), at.guard, at.y(), more);
    contact::join(at.contact.samples, at.origin, more, at.contact.changes);
  }
  bool complete(const Linearisation& at) const override { return mortar::complete(of_mortar(at).frozen); }

  void energy(Positions q, const Linearisation& frozen, device::EnvValues per_env) override {
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

  void max_step(View<const Vec3> dq, Linearisation& out, device::EnvValues alpha) override {
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
  void reach(Linearisation& out) override {
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
    search_.work_on(model_.at_work);
    freeze(view(at), search_, Buffer<double>(margin), rooms_on_ways_, nullptr, false, at.frozen);
  }

  // A contact that grows stiffer under load is energy from nowhere, so all of an environment grow by no more than its budget pays for, the guard
  // with them.
  void adapt(const StepInfo& step, const std::vector<double>& budget, const Linearisation& at) override {
    for (std::size_t i = 0; i < kappa_.size(); ++i)
      if (step.taken_by(env(i))) next_kappa_[i] = kappa_[i], next_price_[env(i)] = 0;
    if (!automatic_) return;
    std::vector<double> price;
    const std::vector<double> wanted = fitted(of_mortar(at), price);
    if (wanted == kappa_) return;
    const std::vector<double> guard = guard_of(wanted), held = guard_energy(of_mortar(at));
    for (Index e = 0; e < model_.envs; ++e) {
      if (!step.taken_by(e)) continue;
      if (guard[e] != guard_kappa_[e]) price[e] += (guard[e] / guard_kappa_[e] - 1) * held[e];
      const double fraction = price[e] > budget[e] ? budget[e] / price[e] : 1;
      next_price_[e] = fraction * price[e];
      for (std::size_t i = 0; i < kappa_.size(); ++i)
        if (env(i) == e) next_kappa_[i] = fraction == 1 ? wanted[i] : kappa_[i] + fraction * (wanted[i] - kappa_[i]);
    }
  }

  // A static step ends with the stiffness that its own pressure asks for. In motion that would be energy from nowhere.
  void refit(Positions, const Linearisation& at, std::vector<Refit>& per_env) override {
    if (!automatic_ || !static_) return;
    std::vector<double> price;
    const std::vector<double> wanted = fitted(of_mortar(at), price);
    std::vector<std::uint8_t> changed(model_.envs, 0);
    for (std::size_t i = 0; i < kappa_.size(); ++i)
      if (wanted[i] > tuning::kSame * kappa_[i] || kappa_[i] > tuning::kSame * wanted[i]) changed[env(i)] = 1;
    bool any = false;
    for (std::size_t i = 0; i < kappa_.size(); ++i) {
      if (!changed[env(i)]) continue;
      any = true;
      kappa_[i] = wanted[i];
      per_env[env(i)] = std::max(per_env[env(i)], Refit::from_here);
    }
    if (any) stiffness_changed();
  }

  void report(const FieldSinks& sinks, const Linearisation& at) override;
  void checkpoint(Archive& archive) override {
    // Interfaces are listed pair by pair, in every environment.
    std::vector<Index> order(kappa_.size()), of;
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [this](Index a, Index b) { return env(a) < env(b); });
    std::vector<double> kappa;
    for (Index i : order) kappa.push_back(next_kappa_[i]), of.push_back(env(i));
    archive.io("stiffness", kappa, firsts(of, model_.envs));
    archive.io("stiffening", next_price_, one_each(model_.envs));
    std::vector<double> support = support_.download();
    archive.io("support_radius", support, in_values(slave_env_));
    if (!archive.loading()) return;
    if (kappa.size() != kappa_.size() || support.size() != static_cast<std::size_t>(support_.size()))
      throw Error(Exit::file, "the checkpoint belongs to another scene: it has " + std::to_string(kappa.size()) + " contact pairs");
    for (std::size_t i = 0; i < order.size(); ++i)
      if (archive.loads(of[i])) next_kappa_[order[i]] = kappa_[order[i]] = kappa[i];
    support_.upload(support);
    stiffness_changed();
    started_ = true;
  }

 private:
  // Gap beyond the support radius up to which samples are wanted, in every environment [m].
  std::vector<double> more_reach() const {
    std::vector<double> out;
    for (double d_hat : d_hat_) out.push_back(set_.averaged ? (tuning::kAverageReach - 1) * d_hat : 0);
    return out;
  }

  void choose_pairs(const Params& list, bool two_pass) {
    const Index n = static_cast<Index>(model_.bodies.size()), planes = static_cast<Index>(model_.half_spaces.size());
    const geometry::BodyPairs& pairs = model_.surface.pairs;
    std::vector<Index> interface_of_pair(pairs.size(planes), -1);
    const auto add = [&](Index slave, Index master, const SourceLoc& at) {
      if (interface_of_pair[pairs.of(slave, master)] >= 0) throw Error(Exit::scene, at, "this pair is listed twice");
      interface_of_pair[pairs.of(slave, master)] = static_cast<Index>(interfaces_.size());
      interfaces_.push_back(interface_of(model_, slave, master));
    };
    for (const Params& pair : list.items()) {
      const std::string &slave = pair.text("slave"), &master = pair.text("master");
      bool slave_found = false, master_found = false;
      for (Index a = 0; a < n; ++a) {
        if (model_.bodies[a].name != slave) continue;
        slave_found = true;
        for (Index b = 0; b < n + planes; ++b) {
          const bool plane = b >= n;
          if ((plane ? model_.half_spaces[b - n].name : model_.bodies[b].name) != master) continue;
          master_found = true;
          if (a == b) throw Error(Exit::scene, pair.where(), "a body cannot be its own master: use barrier_contact for self-contact");
          if (!plane && model_.bodies[a].env != model_.bodies[b].env) continue;
          add(a, b, pair.where());
          if (two_pass && !plane) add(b, a, pair.where());
        }
      }
      if (!slave_found) throw Error(Exit::scene, pair.at("slave").where(), "no soft or stiff body is called '" + slave + "'");
      if (!master_found) throw Error(Exit::scene, pair.at("master").where(), "no body is called '" + master + "'");
    }
    interface_at_.upload(interface_of_pair);
  }

  void choose_slaves() {
    const Index n = static_cast<Index>(model_.bodies.size());
    std::vector<std::uint8_t> is_slave(n, 0), is_master(n, 0);
    for (const Interface& i : interfaces_) {
      is_slave[i.slave] = 1;
      if (i.master < n) is_master[i.master] = 1;
    }
    std::vector<Index> slaves, masters, env, master_env, triangle_env;  // bodies are in order of environment
    for (Index b = 0; b < n; ++b)
      for (Index t = model_.bodies[b].triangle_begin; t < model_.bodies[b].triangle_end; ++t) {
        const Index e = model_.bodies[b].env;
        triangle_env.push_back(e);
        if (is_slave[b]) slaves.push_back(t), env.push_back(e);
        if (is_master[b]) masters.push_back(t), master_env.push_back(e);
      }
    slaves_.upload(slaves);
    std::vector<double> support;
    for (Index e : env) support.push_back(d_hat_[e]);
    support_.upload(support);
    slave_env_ = env_offsets(env, model_.envs);
    triangle_env_ = env_offsets(triangle_env, model_.envs);
    search_ = Search(slave_env_, masters, env_offsets(master_env, model_.envs), model_.surface.triangles.download());
  }

  void watch() {
    const Index n = static_cast<Index>(model_.bodies.size());
    contact::WatchedPairs pairs(model_);
    std::vector<std::uint8_t> directed(pairs.of.size(0), 0);
    for (const Interface& i : interfaces_) {
      pairs.set(i.slave, i.master, contact::Watch::contact);
      if (i.master < n) directed[pairs.of.of(i.slave, i.master)] = 1;
    }
    contact::complete(model_, pairs);
    proximity_.watch(pairs);
    directed_.upload(directed);
  }

  static std::span<const Sample> of_env(const MortarLinearisation& at, const std::vector<Sample>& samples, Index env) {
    const std::vector<Index>& first = at.frozen.env_samples;
    return std::span(samples).subspan(first[env], first[env + 1] - first[env]);
  }
  Index env(std::size_t interface) const { return model_.bodies[interfaces_[interface].slave].env; }

  contact::Where where(const Buffer<Vec3>& y) { return {proximity_.held(), y, model_.at_work, model_.working(proximity_.vertex_env())}; }

  mortar::MortarView view(const MortarLinearisation& at) const {
    geometry::SurfaceView surface = model_.surface.view();
    surface.pair_allowed = directed_.view();
    return {set_,
            surface,
            proximity_.topology(),
            interface_at_.view(),
            kappa_view_.view(),
            d_hat_view_.view(),
            proximity_.planes(),
            slaves_.view(),
            support_.view(),
            at.normal.view(),
            at.area.view(),
            std::as_const(model_.faces.nodes).view(),
            std::as_const(model_.faces.quarter).view(),
            at.bow.view()};
  }
  // The guard is the barrier of barrier_contact in its classic form: every pair of primitives has the same weight. With the mean
  // third of a slave triangle as that weight its stiffness is that of the mortar samples.
  contact::BarrierView guard_view() const {
    contact::BarrierParams barrier;
    barrier.area_weighted = false;
    return proximity_.view(barrier, guard_kappa_view_, {}, {});
  }

  std::vector<double> cover_of(const MortarLinearisation& at, const std::vector<Vec3>& y, const std::vector<Pair>& pairs, std::vector<double>& share);

  void measure(MortarLinearisation& at) const {
    mortar::measure(model_.surface.view(), model_.faces, at.y(), model_.working(triangle_env_), at.normal, at.area, at.bow);
  }
  // Samples within range at y.
  void refreeze(MortarLinearisation& at) {
    measure(at);
    search_.work_on(model_.at_work);
    freeze(view(at), search_, margin_, rooms_, nullptr, false, at.frozen);
  }

  // From the state at the start.
  void fit_support() {
    if (!(rest_ > 0)) return;
    MortarLinearisation at(model_.envs);
    proximity_.locate(std::as_const(model_.q).view(), at.frozen.y);
    refreeze(at);
    Buffer<double> least;
    least_gaps(view(at), search_, at.y(), least);
    std::vector<double> support = least.download();
    for (Index e = 0; e < model_.envs; ++e)
      for (Index t = slave_env_[e]; t < slave_env_[e + 1]; ++t)
        support[t] = std::clamp(rest_ * support[t], tuning::kLeastSupport * d_hat_[e], d_hat_[e]);
    support_.upload(support);
  }

  // Per environment [J].
  std::vector<double> guard_energy(const MortarLinearisation& at) {
    std::vector<double> per_env(model_.envs, 0.0);
    if (!(guard_ > 0)) return per_env;
    device::Fetch fetch;
    contact::energy(guard_view(), where(at.frozen.y), {per_env, fetch});
    fetch.now("energies");
    return per_env;
  }

  // The stiffnesses, those anew whose k has left 2..8, at the pressure that the frozen samples found; `price`: what the change adds to
  // the energy of the samples of every environment [J].
  std::vector<double> fitted(const MortarLinearisation& at, std::vector<double>& price) const {
    const std::vector<Pair> pairs = at.frozen.pairs.download();
    const std::vector<Sample> samples = at.frozen.samples.download();
    price.assign(model_.envs, 0.0);
    std::vector<double> wanted = kappa_;
    for (std::size_t i = 0; i < interfaces_.size(); ++i) {
      const Achieved now = achieved(interfaces_[i], static_cast<Index>(i), kappa_[i], pairs, of_env(at, samples, env(i)));
      if (!(now.pressure > 0) || fits(interfaces_[i], now, kappa_[i])) continue;
      wanted[i] = wanted_stiffness(interfaces_[i], d_hat_[env(i)], now.pressure, static_ ? tuning::kOpen : tuning::kSoftest);
      price[env(i)] += (wanted[i] / kappa_[i] - 1) * now.energy;
    }
    return wanted;
  }

  std::vector<double> guard_of(const std::vector<double>& kappa) const {
    std::vector<double> largest(model_.envs, 0.0);
    for (std::size_t i = 0; i < kappa.size(); ++i) largest[env(i)] = std::max(largest[env(i)], kappa[i] * interfaces_[i].h * interfaces_[i].h / 7);
    return largest;
  }

  void stiffness_changed() {
    kappa_view_.upload(kappa_);
    guard_kappa_ = guard_of(kappa_);
    std::vector<double> stiffness;
    for (Index e = 0; e < model_.envs; ++e) stiffness.push_back(guard_kappa_[e] / (proximity_.reach(e) * proximity_.reach(e)));
    guard_kappa_view_.upload(stiffness);
  }

  std::vector<double> guard_ranges() const {
    std::vector<double> out;
    for (double d_hat : d_hat_) out.push_back(std::max(guard_, tuning::kLeastGuard) * d_hat);
    return out;
  }

  model::Model& model_;
  Settings set_;
  std::vector<double> d_hat_;  // per environment [m]
  double guard_, rest_;
  bool automatic_ = false, started_ = false;
  std::vector<Interface> interfaces_;       // interfaces
  std::vector<double> kappa_, next_kappa_;  // of this step, and for the next
  std::vector<double> next_price_;          // per environment: energy that the change to next_kappa_ adds [J]
  bool static_ = false;
  std::vector<double> guard_kappa_;  // per environment: kappa times the weight of a guard pair [N]
  Buffer<double> guard_kappa_view_;  // the same over the square of its range [Pa]
  contact::Proximity proximity_;
  contact::TermRoom room_;  // of the guard
  Search search_;
  FreezeRoom rooms_, rooms_on_ways_;  // of freezing at iterates, and for what steps may bring into range
  Buffer<Index> interface_at_, slaves_;
  std::vector<Index> slave_env_, triangle_env_;  // first slave, and first triangle, of every environment
  Buffer<double> kappa_view_, d_hat_view_, support_, margin_;
  Buffer<std::uint8_t> directed_;
};

// Areas of points that lie over or under the other surface: of a point of slaves and masters the larger [m^2]. What is farther than the longest edge
// of a slave in contact covers nothing. share: what of every triangle is covered by triangles.
std::vector<double> MortarContact::cover_of(const MortarLinearisation& at, const std::vector<Vec3>& y, const std::vector<Pair>& pairs,
                                            std::vector<double>& share) {
  std::vector<double> reach = more_reach();
  for (const Pair& p : pairs)
    for (int k = 0; k < 3; ++k) {
      const Index a = p.on.point[p.on.vertex(k)], b = p.on.point[p.on.vertex((k + 1) % 3)];
      reach[p.env] = std::max(reach[p.env], (y[a] - y[b]).norm());
    }
  Buffer<double> wide;
  wide.upload(reach);
  search_.work_on(model_.at_work);
  search_.update(view(at), at.y(), wide);
  Buffer<Cover> buffer;
  cover(view(at), search_, at.y(), buffer);
  const std::vector<Triangle> triangles = model_.surface.triangles.download();
  std::vector<double> on(model_.points, 0.0), under(model_.points, 0.0);
  share.assign(triangles.size(), 0.0);
  for (const Cover& c : buffer.download()) {
    if (c.master >= 0) share[c.slave] += c.share;
    for (int k = 0; k < 3; ++k) {
      on[triangles[c.slave].v[k]] += c.N[k];
      if (c.master >= 0) under[triangles[c.master].v[k]] += c.M[k];
    }
  }
  for (std::size_t i = 0; i < on.size(); ++i) on[i] = std::max(on[i], under[i]);
  return on;
}

void MortarContact::report(const FieldSinks& sinks, const Linearisation& accepted) {
  const MortarLinearisation& at = of_mortar(accepted);
  const std::vector<Pair> pairs = at.frozen.pairs.download();
  const std::vector<Sample> samples = at.frozen.samples.download();
  const std::vector<model::ContactSample> contact_samples = at.contact.samples.download();
  const std::string group(name());
  struct Own {  // of an environment
    contact::SampleRows rows, guard_rows;
    std::vector<double> kind;
    double total[kKinds + 1] = {};  // by kind, then the guard
    double closest;
  };
  std::vector<Own> own;
  for (Index e = 0; e < model_.envs; ++e) own.push_back({{model_, e}, {model_, e}, {}, {}, d_hat_[e]});

  // What hat functions make of the pressures [N]: on quadratic faces those of their quarters, whose shares are nowhere negative.
  std::vector<double> load(3 * static_cast<std::size_t>(model_.points), 0.0);
  const auto press = [&](Index point, const Vec3& force) { Eigen::Map<Vec3>(load.data() + 3 * point) += force; };
  contact::PointForces forces(model_, at.frozen.y);
  std::vector<double> share;
  std::vector<double> covered = cover_of(at, forces.places(), pairs, share);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Sample& s = samples[i];
    const Pair& pair = pairs[s.pair];
    const model::ContactSample& c = contact_samples.at(at.place(pair.env, static_cast<Index>(i)));
    Own& mine = own[c.env];
    Vec3 J[kPoints];
    jacobian(pair, s, J);
    for (int k = 0; k < points_of(pair); ++k) {
      const Index p = point_of(pair, k);
      forces.add(p, c.pressure * c.area * J[k], forces.body(p) == c.body_a ? c.body_b : c.body_a);
    }
    const Vec3 on_master = c.pressure * c.area * Vec3(c.normal[0], c.normal[1], c.normal[2]);
    for (int k = 0; k < 3; ++k) {
      const Index on = pair.on.point[pair.on.vertex(k)], under = pair.master < 0 ? -1 : pair.under.point[pair.under.vertex(k)];
      press(on, (under < 0 ? s.N[k] : -s.N[k]) * on_master);  // a half-space's normal points at the slave
      if (under >= 0) press(under, s.M[k] * on_master);
      if (s.kind == SampleKind::face) continue;
      covered[on] += s.N[k] * c.area;
      if (under >= 0) covered[under] += s.M[k] * c.area;
    }
    mine.total[static_cast<Index>(s.kind)] += c.force;
    // Curved faces may meet between their nodes; what is kept apart are their quarters, and none within reach is nearer than they are.
    mine.closest = std::min(mine.closest, pair.quadratic() ? std::max(c.gap, proximity_.reach(c.env)) : c.gap);
    mine.rows.add(c);
    mine.kind.push_back(static_cast<double>(s.kind));
  }
  if (guard_ > 0) {
    Buffer<Vec3> buffer;
    contact::point_forces(guard_view(), at.guard, at.y(), buffer);
    const std::vector<Vec3> guard = buffer.download();
    const std::vector<contact::Active> terms = at.guard.terms.download();
    for (std::size_t i = 0; i < terms.size(); ++i) {
      const model::ContactSample& c = contact_samples.at(at.guard_place(terms[i].env, static_cast<Index>(i)));
      Own& mine = own[c.env];
      mine.total[kKinds] += guard[4 * i].norm();
      for (int k = 0; k < 4; ++k) {
        const Index p = terms[i].point[k];
        if (p < 0) continue;
        forces.add(p, guard[4 * i + k], forces.body(p) == c.body_a ? c.body_b : c.body_a);
        press(p, guard[4 * i + k]);
      }
      mine.guard_rows.add(c);
    }
    for (Index e = 0; e < sinks.size(); ++e) own[e].guard_rows.report(sinks[e], group, "guard_");
  }
  forces.report(sinks, group);
  const contact::NodalPressure nodal = contact::nodal_pressure(model_.surface, forces.places(), load, covered);
  report_points(sinks, model_, "contact_pressure", "Pa", 1, nodal.pressure);
  report_points(sinks, model_, "contact_area", "m^2", 1, nodal.area);

  const std::vector<double> distance = contact::least_distances(proximity_.obstacles(guard_view()), proximity_.candidates(at.frozen.y), at.y(),
                                                                proximity_.vertex_env()),
                            energy = energies_now(std::as_const(model_.q).view(), at, model_.envs);
  for (Index e = 0; e < sinks.size(); ++e) {
    if (!sinks.wanted(e)) continue;
    FieldSink& sink = sinks[e];
    Own& mine = own[e];
    mine.rows.report(sink, group);
    sink.scalar(group, "pressure_sum_defect", "1", contact::sum_defect(forces, {&mine.rows, &mine.guard_rows}));
    sink.rows(group, "kind", "1", 1, mine.kind);
    if (distance[e] < proximity_.reach(e)) mine.closest = std::min(mine.closest, distance[e]);
    sink.scalar(group, "min_distance", "m", mine.closest);
    // The stiffness that the next step begins with was paid for by this one.
    sink.scalar(group, "energy", "J", energy[e] + next_price_[e]);
    sink.scalar(group, "active_pairs", "1", static_cast<double>(at.frozen.env_pairs[e + 1] - at.frozen.env_pairs[e]));
    const double sum = mine.total[0] + mine.total[1] + mine.total[2] + mine.total[3];
    const char* const share_names[] = {"force_share_faces", "force_share_edges", "force_share_points", "force_share_guard"};
    for (int k = 0; k <= kKinds; ++k) sink.scalar(group, share_names[k], "1", sum > 0 ? mine.total[k] / sum : 0);
    double defect = 0;  // of slaves whose pieces add up to their area but for rounding; stacked layers count more than once
    for (Index t = triangle_env_[e]; t < triangle_env_[e + 1]; ++t)
      if (std::abs(share[t] - 1) < 1e-6) defect = std::max(defect, std::abs(share[t] - 1));
    sink.scalar(group, "clip_partition_defect", "1", defect);
  }
  for (std::size_t i = 0; i < interfaces_.size(); ++i) {
    const Interface& between = interfaces_[i];
    const Index n = static_cast<Index>(model_.bodies.size());
    const std::string pair = model_.bodies[between.slave].name + "_" +
                             (between.master < n ? model_.bodies[between.master].name : model_.half_spaces[between.master - n].name);
    sinks[env(i)].scalar(group, "stiffness_" + pair, "Pa", kappa_[i]);
    sinks[env(i)].scalar(group, "k_" + pair, "1", achieved(between, static_cast<Index>(i), kappa_[i], pairs, of_env(at, samples, env(i))).k);
  }
}

}  // namespace

const Kind& mortar_contact_kind() {
  static const Kind kind = Kind{"mortar_contact",
                                Role::contact,
                                "contact pressure as a field: barrier over the exact overlap of two surfaces (GMCP)",
                                &kTable,
                                [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<MortarContact>(p, m); },
                                {"Liang, Han: IsaacIPC (geometric mortar contact potential). arXiv:2605.24339, 2026",
                                 "Puso, Laursen: A mortar segment-to-segment contact method for large deformation solid mechanics. CMAME 193, 2004",
                                 "Li, Kaufman, Jiang: Convergent Incremental Potential Contact. arXiv:2307.15908, 2023"},
                                {"contact_force", "contact_pressure", "contact_area"},
                                {},
                                false}
                               .differing_in({"d_hat", "stiffness"});  // samples are frozen (frozen.h)
  return kind;
}

const Kind& MortarContact::kind() const { return mortar_contact_kind(); }

}  // namespace mortise::effects
