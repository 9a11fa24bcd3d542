#include "effects/affine_body/affine_body.h"

#include <algorithm>
#include <numeric>
#include <sstream>
#include <utility>

#include "effects/body_blocks.h"
#include "effects/list.h"
#include "effects/per_environment.h"
#include "model/radius.h"

namespace mortise::effects {
namespace {

const ParamTable kTable{
    "effect affine_body",
    "Keeps stiff bodies from deforming.",
    {param::positive(param::automatic(param::number("stiffness", Unit::pressure, "100 MPa", 0,
                                                    "Penalty on strain of the body, well above the moduli of what touches it; auto, or "
                                                    "without it, 100 MPa or a hundred times the largest Young's modulus of the scene's soft "
                                                    "bodies, whichever is more")))}};

// With as much as a soft body that it is joined to a stiff one would give way as much as that: at 100 MPa a plate between blocks of steel bore 0.4 %
// of its load.
constexpr double kStiffness = 1e8;  // [Pa]
constexpr double kStiffer = 100;    // times the stiffest soft body: what is left out of a sandwich is a share of a hundredth of a layer's

double stiffness_of(const Params& params, const model::Model& model, Index env) {
  if (const Params* given = model.input.effect_of(params, env).find("stiffness")) return given->as_number();
  double stiffest = 0;
  for (const model::Body& body : model.bodies)
    if (body.env == env && body.type == model::BodyType::soft) stiffest = std::max(stiffest, body.youngs_modulus);
  return std::max(kStiffness, kStiffer * stiffest);
}

// In statics a body is made stiffer until its strain moves its farthest point by less than kOfWay of how far that is from rest, or of kNoWay of its
// radius where it hardly moved. A post of 1 m on a pad of 10 mm gave way by an eighth of what the pad did.
constexpr double kOfWay = 0.005, kNoWay = 2e-4;
constexpr double kAtOnce = 1e3;  // so many times stiffer at most for that

struct StiffBody {
  Index first;  // block of a1; a2 and a3 follow
  double V;     // [m^3]
  double Vk;    // [J]
  double R;     // of its farthest point from p, at rest [m]
};

// Of a state.
struct Shape {
  double defect;    // |A^T A - I|_F, about twice the body's largest strain
  double strained;  // what that moves its farthest point by [m]
  double way;       // |p - p_0| + |A - I|_F R: no point is farther from rest; or, where it hardly moved, a share of R [m]
};

MORTISE_HD inline Mat3 columns(Positions q, Index first) {
  Mat3 A;
  for (int i = 0; i < 3; ++i) A.col(i) = q[first + i];
  return A;
}

class AffineBody final : public Effect {
 public:
  AffineBody(const Params& params, model::Model& model) : model_(model) {
    for (Index e = 0; e < model.envs; ++e) given_.push_back(stiffness_of(params, model, e));
    const std::vector<Vec3> rest = model.rest_points.download();
    std::vector<StiffBody> bodies;
    std::vector<Index> body_env;
    for (const model::Body& body : model.bodies) {
      if (body.type != model::BodyType::stiff) continue;
      bodies.push_back({body.block_begin + 1, body.volume, body.volume * given_[body.env], model::radius(body, rest)});
      stiffness_.push_back(given_[body.env]);
      names_.push_back(body.name);
      body_env.push_back(body.env);
    }
    bodies_.upload(bodies);
    next_stiffness_ = stiffness_;
    env_offset_ = env_offsets(body_env, model.envs);
    env_ = body_env;
  }

  const Kind& kind() const override;
  std::vector<PlanItem> plan() const override { return {{"bodies", bodies_.bytes()}}; }

  void energy(Positions q, const Linearisation&, device::EnvValues per_env) override {
    const View<const StiffBody> list = std::as_const(bodies_).view();
    device::env_sum(
        "affine_body.energy", env_offset_, [=] MORTISE_HD(Index s) { return affine_body::energy(list[s].Vk, columns(q, list[s].first)); }, per_env);
  }

  void linearise(Positions q, Want want, Linearisation& at) override {
    if (!want.forces) return;
    const bool fresh = at.stencils.resize_uniform(bodies_.size(), 3);
    const Curvature curvature = want.matrix;
    if (curvature.wanted) at.stencils.need_hessian();
    const View<const StiffBody> list = std::as_const(bodies_).view();
    const View<const Index> env = std::as_const(model_.block_env).view();
    const linalg::StencilView out = at.stencils.view();
    device::parallel_for("affine_body.assemble", list.n, [=] MORTISE_HD(Index s) {
      const Mat3 A = columns(q, list[s].first);
      const Mat3 g = affine_body::gradient(list[s].Vk, A);
      for (int i = 0; i < 3; ++i) out.block[3 * s + i] = list[s].first + i, out.grad[3 * s + i] = g.col(i);
      if (curvature.wanted) affine_body::hessian(list[s].Vk, A, curvature.concavity(env[list[s].first]), out.hess.p + 6 * s);
    });
    if (fresh) at.stencils.pattern_changed();
  }

  void turning(Positions q, Positions way, device::EnvValues most) override {
    const View<const StiffBody> list = std::as_const(bodies_).view();
    device::env_max(
        "affine_body.turning", env_offset_,
        [=] MORTISE_HD(Index s) { return affine_body::turn(columns(q, list[s].first), columns(way, list[s].first)).norm(); }, most);
  }

  void bend(Positions q, View<Vec3> way) override {
    const View<const StiffBody> list = std::as_const(bodies_).view();
    const View<const Mat3> P = std::as_const(model_.projector).view();
    device::parallel_for("affine_body.bend", list.n, [=] MORTISE_HD(Index s) {
      const Index first = list[s].first;
      for (int i = 0; i < 3; ++i)
        if (!(P[first + i] - Mat3::Identity()).isZero(0)) return;  // it goes as it is told
      const Mat3 A = columns(q, first), dA = columns(way, first);
      const Mat3 arc = affine_body::bent(A, dA, affine_body::turn(A, dA));
      for (int i = 0; i < 3; ++i) way[first + i] = arc.col(i);
    });
  }

  std::vector<Shape> shapes(Positions q) const {
    const View<const StiffBody> list = std::as_const(bodies_).view();
    const Positions rest = std::as_const(model_.rest).view();
    device::Buffer<Shape> shape(list.n);
    const View<Shape> out = shape.view();
    device::parallel_for("affine_body.shape", list.n, [=] MORTISE_HD(Index s) {
      const Mat3 A = columns(q, list[s].first);
      const Index p = list[s].first - 1;
      const double defect = affine_body::defect(A).norm(), R = list[s].R;
      out[s] = {defect, defect * R / 2, std::fmax((q[p] - rest[p]).norm() + (A - Mat3::Identity()).norm() * R, kNoWay * R)};
    });
    return shape.download();
  }

  // The stiffness is a penalty: a body that a step strains by more than a percent takes the step anew with a larger one.
  void refit(Positions q, const Linearisation&, std::vector<Refit>& per_env) override {
    constexpr double kStiff = 0.02, kLargest = 1e6;  // |A^T A - I|; of the given stiffness: there rounding of q begins to tell
    const std::vector<Shape> shape = shapes(q);
    bool changed = false;
    for (std::size_t i = 0; i < shape.size(); ++i) {
      const double defect = shape[i].defect, given = given_[env_[i]];
      const auto stiffen = [&](double factor, double most, Refit how) {
        if (!(stiffness_[i] < most * given)) return;
        stiffness_[i] = std::min(factor * stiffness_[i], most * given);
        per_env[env_[i]] = std::max(per_env[env_[i]], how);
        changed = true;
      };
      // The defect falls as the stiffness grows, once it is small; a body that is flat says nothing about how much more is needed.
      const double enough = kOfWay * shape[i].way;
      if (defect > kStiff)
        stiffen(defect > 0.5 ? 1e3 : 2 * defect / kStiff, kLargest, Refit::from_start);
      else if (is_static_ && shape[i].strained > enough)
        stiffen(2 * shape[i].strained / enough, kAtOnce, Refit::from_here);
    }
    if (changed) stiffness_changed();
  }

  void begin_step(const StepInfo& step) override {
    is_static_ = step.is_static;
    if (copy_taken(step, next_stiffness_, stiffness_)) stiffness_changed();
  }
  void end_step(const StepInfo& step, Positions, const Linearisation&) override { copy_taken(step, stiffness_, next_stiffness_); }
  void checkpoint(Archive& archive) override {
    archive.io("stiffness", next_stiffness_, firsts(env_, model_.envs));
    if (!archive.loading()) return;
    for (std::size_t i = 0; i < stiffness_.size() && i < env_.size(); ++i)
      if (archive.loads(env_[i])) stiffness_[i] = next_stiffness_.at(i);
    stiffness_changed();
  }

  void object(Positions q, std::vector<std::string>& per_env) override {
    constexpr double kMost = 0.1;  // 5 % of strain: a body that was to be stiff is not
    const std::vector<Shape> shape = shapes(q);
    std::vector<double> worst(per_env.size(), kMost);
    for (std::size_t i = 0; i < shape.size(); ++i) {
      if (!(shape[i].defect > worst[env_[i]])) continue;
      worst[env_[i]] = shape[i].defect;
      std::ostringstream why;
      why.precision(2);
      why << "the stiff body '" << names_[i] << "' is strained by " << 50 * shape[i].defect << " %, however stiff it is made: it is crushed";
      per_env[env_[i]] = why.str();
    }
  }

  void report(const FieldSinks& sinks, const Linearisation& at) override {
    const Positions q = std::as_const(model_.q).view();
    const std::vector<Shape> shape = shapes(q);
    std::vector<double> worst(model_.envs, 0.0), stiffest(model_.envs, 0.0);
    for (std::size_t i = 0; i < shape.size(); ++i) {
      worst[env_[i]] = std::max(worst[env_[i]], shape[i].defect);
      stiffest[env_[i]] = std::max(stiffest[env_[i]], stiffness_[i]);
    }
    sinks.scalar("affine_body", "rigidity_defect", "1", worst);
    for (Index e = 0; e < sinks.size(); ++e)
      if (env_offset_[e] < env_offset_[e + 1]) sinks[e].scalar("affine_body", "stiffness_largest", "Pa", stiffest[e]);
    sinks.scalar("affine_body", "energy", "J", energies_now(q, at, model_.envs));
  }

 private:
  // Of the bodies of environments that take the step; says whether anything changed.
  bool copy_taken(const StepInfo& step, const std::vector<double>& from, std::vector<double>& to) const {
    bool changed = false;
    for (std::size_t i = 0; i < to.size(); ++i) {
      if (!step.taken_by(env_[i]) || to[i] == from[i]) continue;
      to[i] = from[i];
      changed = true;
    }
    return changed;
  }
  void stiffness_changed() {
    std::vector<StiffBody> bodies = bodies_.download();
    for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i].Vk = bodies[i].V * stiffness_[i];
    bodies_.upload(bodies);
  }

  model::Model& model_;
  bool is_static_ = false;
  std::vector<double> given_;                       // per environment [Pa]
  std::vector<double> stiffness_, next_stiffness_;  // per body, in this step and for the next [Pa]
  device::Buffer<StiffBody> bodies_;
  std::vector<std::string> names_;
  std::vector<Index> env_, env_offset_;  // per body; per environment
};

}  // namespace

const Kind& affine_body_kind() {
  static const Kind kind = Kind{"affine_body",
                                Role::store,
                                "stiff bodies keep their shape",
                                &kTable,
                                [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<AffineBody>(p, m); },
                                {"Lan, Kaufman, Li, Jiang, Yang: Affine Body Dynamics: Fast, Stable and Intersection-free Simulation of Stiff "
                                 "Materials. ACM TOG 41(4), 2022"}}
                               .differing_in({"stiffness"});
  return kind;
}

const Kind& AffineBody::kind() const { return affine_body_kind(); }

}  // namespace mortise::effects
