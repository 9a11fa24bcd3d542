#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "effects/contact/change_stencils.h"
#include "effects/friction/accepted.h"
#include "effects/friction/anchors.h"
#include "effects/friction/creep.h"
#include "effects/friction/law.h"
#include "effects/friction/slips.h"
#include "effects/friction/tuning.h"
#include "effects/list.h"
#include "model/contact_view.h"
#include "model/expand.h"
#include "model/model.h"

namespace mortise::effects {
namespace {

using device::Buffer;
using friction::FrozenContact;
using friction::Slips;
using model::ContactSample;

const ParamTable kPair{"friction pair",
                       "Friction coefficient of one pair of bodies.",
                       {param::required(param::of(Param::Kind::text, "a", Unit::none, {}, "One body")),
                        param::required(param::of(Param::Kind::text, "b", Unit::none, {}, "The other body")),
                        param::required(param::number("mu", Unit::none, "0", 0, "Friction coefficient of this pair"))}};

Param pairs_param() {
  Param p = param::optional(param::of(Param::Kind::tables, "pairs", Unit::none, {}, "Pairs whose coefficient differs from mu"));
  p.sub = &kPair;
  return p;
}

const ParamTable kTable{
    "effect friction",
    "Coulomb friction of the contact that it follows; what sticks holds from step to step.",
    {param::of(Param::Kind::text, "follows", Unit::none, "barrier_contact", "The contact effect whose forces cause the friction"),
     param::number("mu", Unit::none, "0.5", 0, "Friction coefficient"), pairs_param(),
     param::positive(param::automatic(
         param::number("creep_speed", Unit::velocity, "1e-4 m/s", 0,
                       "Slip speed below which friction falls smoothly to zero: what sticks gives way by less than a step of this, once; "
                       "auto, or without it, 1e-4 m/s, but no more than a twentieth of d_hat in a step"))),
     param::positive(param::number("lag_tolerance", Unit::none, "1e-3", 0,
                                   "Residual with refreshed contact forces at which lagging ends, as a share of the largest force")),
     param::range(param::of(Param::Kind::integer, "lag_iterations", Unit::none, "20", "Most refreshes of the contact forces in a step"), 1, 1000)}};

// Named twice, a pair would have two coefficients.
void each_once(const Params& pairs) {
  std::set<std::pair<std::string, std::string>> seen;
  for (const Params& pair : pairs.items())
    if (const std::string& a = pair.text("a"), &b = pair.text("b"); !seen.insert(std::minmax(a, b)).second)
      throw Error(Exit::scene, pair.where(), "friction of '" + a + "' and '" + b + "' has a coefficient already; name a pair once");
}

// The samples of some state, and what became of them; the stencils are theirs.
struct FrictionLinearisation final : Linearisation {
  Buffer<ContactSample> samples;
  model::SampleChanges changes;  // of them, as the contact effect knows it
  std::vector<Index> env_offset;
  Buffer<double> weights;
  Buffer<FrozenContact> frozen;
  std::size_t bytes() const override { return Linearisation::bytes() + samples.bytes() + changes.bytes() + weights.bytes() + frozen.bytes(); }
};

class Friction final : public Effect {
 public:
  Friction(const Params& p, model::Model& model) : model_(model), where_(p.where()), follows_(p.text("follows")), anchors_(model), accepted_(model) {
    const geometry::BodyPairs& pairs = model.surface.pairs;
    const Index bodies = pairs.bodies(), planes = static_cast<Index>(model.half_spaces.size());
    std::vector<double> mu(pairs.size(model.half_spaces.size()), 0.0);
    for (Index e = 0; e < model.envs; ++e) {
      const Params& own = model.input.effect_of(p, e);
      creep_of_.push_back(friction::creep(p, model.input, e));
      for (Index a = model.env_bodies[e]; a < model.env_bodies[e + 1]; ++a) {
        for (Index b = model.env_bodies[e]; b < model.env_bodies[e + 1]; ++b) mu[pairs.of(a, b)] = own.number("mu");
        for (Index plane = bodies; plane < bodies + planes; ++plane) mu[pairs.of(a, plane)] = own.number("mu");
      }
      const Params* list = own.find("pairs");
      if (list) each_once(*list);
      for (std::size_t i = 0; list && i < list->items().size(); ++i) {
        const Params& pair = list->items()[i];
        for (Index a : find(pair.at("a")))
          for (Index b : find(pair.at("b")))
            for (const auto& [first, second] : {std::pair{a, b}, std::pair{b, a}})
              if (first < bodies && model.bodies[first].env == e && model.same_env(first, second)) mu[pairs.of(first, second)] = pair.number("mu");
      }
    }
    mu_.upload(mu);
    dt_.assign(model.envs, 1.0);
    set_creep();
  }

  const Kind& kind() const override;
  std::string_view follows() const override { return follows_; }

  void connect() override {
    if (model_.has_contact(follows_)) return;
    throw Error(Exit::scene, where_,
                "effect " + std::string(name()) + " follows '" + follows_ + "', but the scene has no contact effect of that name");
  }

  void begin_step(const StepInfo& info) override {
    for (Index e = 0; e < model_.envs; ++e)
      if (info.taken_by(e)) dt_[e] = info.dt;
    set_creep();
    q0_.copy_from(model_.q);
  }

  std::unique_ptr<Linearisation> linearisation() const override {
    auto at = std::make_unique<FrictionLinearisation>();
    at->env_offset.assign(model_.envs + 1, 0);
    return at;
  }

  // Normal forces, normals and weights.
  void lag(const model::ContactView& view, Linearisation& lagged) override {
    auto& at = static_cast<FrictionLinearisation&>(lagged);
    at.samples.copy_from(view.samples);
    at.changes.copy_from(view.changes);
    at.env_offset = view.env_offset;
    friction::freeze(model_.point_map(), at.samples, view, mu_.view(), model_.surface.pairs.view(), anchors(), at.stencils, at.weights, at.frozen);
  }

  void energy(Positions q, const Linearisation& frozen, device::EnvValues per_env) override {
    const auto& at = static_cast<const FrictionLinearisation&>(frozen);
    const Slips s = slips(at);
    device::env_sum(
        "friction.energy", model_.working(at.env_offset),
        [=] MORTISE_HD(Index i) { return s.frozen[i].load * friction::f0(s.slip(i, q).norm(), s.creep(i)); }, per_env);
  }

  void linearise(Positions q, Want want, Linearisation& lagged) override {
    if (!want.forces) return;
    auto& at = static_cast<FrictionLinearisation&>(lagged);
    if (want.whole)
      follow(q, at);
    else
      at.unsymmetric.resize(0, 0);
    const Curvature curvature = want.matrix;  // negative of samples with a negative force
    if (curvature.wanted) at.stencils.need_hessian();
    const Slips s = slips(at);
    const View<const ContactSample> sample = std::as_const(at.samples).view();
    const linalg::StencilView out = at.stencils.view();
    device::parallel_for("friction.assemble", model_.working(at.env_offset), [=] MORTISE_HD(Index i) {
      const Vec3 u = s.slip(i, q);
      const double load = s.frozen[i].load;
      const Vec3 g = (load * friction::f1_over_x(u.norm(), s.creep(i))) * u;
      const Index at = out.offset[i], blocks = out.blocks(i);
      for (Index b = 0; b < blocks; ++b) out.grad[at + b] = s.weight[at + b] * g;
      if (!curvature.wanted) return;
      model::zero_hessian(out, i, blocks);
      const double concave = curvature.concavity(sample[i].env);
      const Mat3 K = friction::hessian(u, s.frozen[i].normal, s.creep(i), load > 0 && concave == 0 ? friction::tuning::kCutSoftening : 1);
      model::add_weighted(out, i, blocks, s.weight.p + at, (load > 0 ? load : concave * load) * K);
    });
  }

  // What forces change by because the samples do.
  void follow(Positions q, FrictionLinearisation& at) const {
    const Slips s = slips(at);
    at.beside.resize_uniform(0, 0);
    if (!at.changes.any()) {
      at.unsymmetric.resize(1, at.stencils.blocks().n);
      const View<const Index> offset = at.stencils.offsets();
      const View<Vec3> left = at.unsymmetric.left.view(), right = at.unsymmetric.right.view();
      const View<const ContactSample> sample = std::as_const(at.samples).view();
      device::parallel_for("friction.follow_force", model_.working(at.env_offset),
                           [=] MORTISE_HD(Index i) { friction::follow_force(s, sample[i], i, q, left.p + offset[i], right.p + offset[i]); });
      return;
    }
    if (!at.changes.scattered()) return follow_changes<model::kSamplePoints>(q, at);
    contact::shape(model_.point_map(), at.changes, at.samples.size(), at.beside);
    follow_changes<model::kChangePoints>(q, at);
  }
  // N: on how many points a sample hangs at most.
  template <Index N>
  void follow_changes(Positions q, FrictionLinearisation& at) const {
    const Slips s = slips(at);
    const model::SampleChangesView change = at.changes.view();
    const model::PointMapView map = model_.point_map();
    constexpr bool scattered = N > model::kSamplePoints;
    const View<const Index> first = at.of_unsymmetric().offsets();
    const Index blocks = at.of_unsymmetric().blocks().n;
    at.unsymmetric.resize(change.functionals, blocks);
    const View<Vec3> left = at.unsymmetric.left.view(), right = at.unsymmetric.right.view();
    const View<const ContactSample> sample = std::as_const(at.samples).view();
    device::parallel_for("friction.follow", model_.working(at.env_offset), [=] MORTISE_HD(Index i) {
      const ContactSample& here = sample[i];
      if (!change.known(i)) {
        for (Index c = 0; c < change.functionals; ++c)
          for (Index b = first[i]; b < first[i + 1]; ++b) left[c * blocks + b] = right[c * blocks + b] = Vec3::Zero();
        friction::follow_force(s, here, i, q, left.p + first[i], right.p + first[i]);
        return;
      }
      const model::Expansion<N> e = scattered ? contact::changed_blocks<N>(map, change, i) : model::expand<N>(map, here.point, here.points);
      Vec3 way[model::kSamplePoints], force[N];  // way: of the points since the step began, from their anchors
      for (Index k = 0; k < e.points; ++k) force[k] = Vec3::Zero();
      for (Index k = 0; k < here.points; ++k) {
        way[k] = s.anchors.of(here, k);
        for (int j = 0; j < model::kPointTerms; ++j)
          if (e.slot[k][j] >= 0) way[k] += e.weight[k][j] * (q[e.block[e.slot[k][j]]] - s.q0[e.block[e.slot[k][j]]]);
      }
      const friction::Sample at{here.weight, way, static_cast<int>(here.points), s.frozen[i].normal, s.frozen[i].load, s.frozen[i].mu};
      for (Index c = 0; c < change.functionals; ++c) {
        friction::change(at, change.force(i, c), change.normal(i, c), change.weight(i, c), s.creep(i), force);
        e.chain(force, left.p + c * blocks + first[i]);
        e.chain(change.along(i, c), right.p + c * blocks + first[i]);
      }
    });
  }

  void end_step(const StepInfo& info, Positions q, const Linearisation& lagged) override {
    const auto& at = static_cast<const FrictionLinearisation&>(lagged);
    accepted_.take(info, slips(at), at.samples, at.env_offset, dt_, q);
    anchors_.keep(slips(at), at.env_offset, q);
  }

  void report(const FieldSinks& sinks, const Linearisation&) override { accepted_.report(sinks); }

  // Everything else is a function of the state at the start of the step.
  void checkpoint(Archive& archive) override {
    accepted_.checkpoint(archive);
    anchors_.checkpoint(archive);
  }

 private:
  std::vector<Index> find(const Params& body) const {
    std::vector<Index> found = model_.bodies_named(body.as_text());
    if (found.empty()) throw Error(Exit::scene, body.where(), "no body is called '" + body.as_text() + "'");
    return found;
  }

  void set_creep() {
    std::vector<double> creep;
    for (Index e = 0; e < model_.envs; ++e) creep.push_back(creep_of_[e].distance(dt_[e]));
    creep_.upload(creep);
  }
  friction::AnchorsView anchors() const { return anchors_.view(creep_.view()); }
  Slips slips(const FrictionLinearisation& at) const {
    return {at.stencils.offsets(), at.stencils.blocks(), at.weights.view(), at.frozen.view(), q0_.view(), anchors(), at.samples.view()};
  }

  model::Model& model_;
  SourceLoc where_;
  std::string follows_;
  std::vector<friction::Creep> creep_of_;  // of every environment
  std::vector<double> dt_;                 // of its step under way [s]
  Buffer<double> creep_;                   // how far what sticks gives way in that [m]
  Buffer<double> mu_;                      // per pair (Surface::pairs)
  Buffer<Vec3> q0_;
  friction::Anchors anchors_;
  friction::Accepted accepted_;
};

}  // namespace

const Kind& friction_kind() {
  static const Kind kind =
      Kind{"friction",
           Role::follower,
           "Coulomb friction of a contact effect; what sticks holds from step to step",
           &kTable,
           [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<Friction>(p, m); },
           {"Li, Ferguson, Schneider, Langlois, Zorin, Panozzo, Jiang, Kaufman: Incremental Potential Contact. ACM TOG 39(4), 2020"},
           {"friction_force"},
           {},
           false,
           true}
          .differing_in({"mu", "pairs", "creep_speed"});
  return kind;
}

const Kind& Friction::kind() const { return friction_kind(); }

}  // namespace mortise::effects
