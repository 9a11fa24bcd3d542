#include "effects/joint/joint.h"

#include <algorithm>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "effects/coordinate_energy.h"
#include "effects/joint/equations.h"
#include "effects/joint/read.h"
#include "effects/joint/stop.h"
#include "effects/joint/usual.h"
#include "effects/per_environment.h"

namespace mortise::effects {
namespace {

class Joints final : public Effect {
 public:
  Joints(const Params& list, model::Model& model) : model_(model), equations_(model) {
    joint::Read read = joint::read(list, model);
    const auto first = static_cast<Index>(model.ties.list().size());
    for (model::Joint& j : read.joints) j.tie += first;
    model.ties.add(model, std::move(read.ties));
    model.joints = std::move(read.joints);
    std::vector<Index> env;
    for (Index e = 0; e < model.envs; ++e)
      for (std::size_t j = 0; j < model.joints.size(); ++j) {
        const model::Joint& joint = model.joints[j];
        if (joint.env != e || !joint.has_coordinate()) continue;
        moving_.push_back(static_cast<Index>(j));
        if (!std::isfinite(joint.low)) continue;
        stopped_.push_back(static_cast<Index>(j)), env.push_back(e);
        stops_.push_back({joint.low, joint.high,
                          std::min(joint.type == model::JointType::prismatic ? joint::tuning::kSlide : joint::tuning::kTurn,
                                   joint::tuning::kShare * (joint.high - joint.low)),
                          read.stop_effort[j] > 0 ? read.stop_effort[j] : usual_effort(joint)});
      }
    energy_.set_environments(env, model.envs);
    upload();
  }

  const Kind& kind() const override;
  std::vector<PlanItem> plan() const override {
    std::vector<PlanItem> out = tie_plan("joint", model_);
    if (!stopped_.empty()) out.push_back({"stops", energy_.bytes()});
    if (equations_.any()) out.push_back({"equations", equations_.bytes()});
    return out;
  }
  std::unique_ptr<Linearisation> linearisation() const override { return std::make_unique<joint::EquationLinearisation>(); }

  void connect() override {
    model::guide(model_);
    equations_.find();
    // Bodies that the scene sets in motion start with rates: rotors of drives turn with them.
    const std::vector<double> rates = rates_of(std::as_const(model_.q).view(), std::as_const(model_.initial_velocity).view());
    for (std::size_t i = 0; i < moving_.size(); ++i) model_.joints[moving_[i]].rate = rates[i];
  }
  void begin_step(const StepInfo& step) override {
    integrator_ = step.is_static ? Integrator{} : step.integrator(0);
    model::guide(model_);
    upload();
    if (equations_.any()) equations_.begin_step(step);
  }
  void energy(Positions q, const Linearisation&, device::EnvValues per_env) override {
    energy_.energy("joint.energy", q, per_env);
    if (equations_.any()) equations_.energy(q, per_env);
  }
  void linearise(Positions q, Want want, Linearisation& at) override {
    if (!equations_.any()) return energy_.linearise("joint.assemble", model_, q, want, at);
    // Stops, then equations.
    const Index stops = energy_.size(), blocks = model::kCoordinateBlocks * stops, pairs = linalg::pair_count(model::kCoordinateBlocks) * stops;
    const bool fresh = want.forces && !at.shaped;
    if (fresh) {
      std::vector<Index> counts(static_cast<std::size_t>(stops), model::kCoordinateBlocks);
      counts.resize(static_cast<std::size_t>(stops + equations_.size()), joint::kEquationBlocks);
      counts.push_back(0);
      at.stencils.resize(device::Buffer<Index>(counts));
    }
    if (want.forces && want.matrix.wanted) at.stencils.need_hessian();
    if (stops > 0) energy_.fill("joint.assemble", model_, q, want, at);
    equations_.fill(q, want, static_cast<joint::EquationLinearisation&>(at), blocks, pairs);
    if (!fresh) return;
    at.stencils.pattern_changed();
    at.shaped = true;
  }
  void max_step(View<const Vec3> dq, Linearisation& at, device::EnvValues alpha) override {
    energy_.max_step("joint.max_step", dq, at, alpha);
    if (equations_.any()) equations_.max_step(dq, static_cast<const joint::EquationLinearisation&>(at), alpha);
  }
  void refit(Positions q, const Linearisation&, std::vector<Refit>& per_env) override {
    if (equations_.any()) equations_.refit(q, per_env);
  }
  void object(Positions q, std::vector<std::string>& per_env) override {
    if (equations_.any()) equations_.object(q, per_env);
  }

  void mend(Fault fault, double share) override {
    if (fault == Fault::steps) mended_ = share;
  }
  // With the accelerations of the leader: of its own, what is mended would take part in the motion.
  void keep_pace(const Effect& leader, Positions q) override {
    if (mended_ == 0 || integrator_.dt == 0) return;
    const Joints& first = static_cast<const Joints&>(leader);
    const std::vector<double> now = first.coordinates(q);
    const LeftOut left = left_out(integrator_, known_);
    led_.resize(moving_.size());
    for (std::size_t i = 0; i < moving_.size(); ++i) {
      const model::Joint& of = first.model_.joints[moving_[i]];
      model::Joint& j = model_.joints[moving_[i]];
      Led& led = led_[i];
      const double a = integrator_.rate(integrator_.rate(now[i], of.value, of.before), of.rate, of.rate_before);
      j.ahead = mended_ * left.rate(integrator_.dt, a, led.a), j.behind = mended_ * left.acceleration(a, led.a, led.a_before);
      led = {a, led.a};
    }
    known_ = std::min(known_ + 1, 2);
  }

  void end_step(const StepInfo& step, Positions q, const Linearisation&) override {
    if (equations_.any()) equations_.end_step(step, q);
    const std::vector<double> now = coordinates(q);
    for (std::size_t i = 0; i < moving_.size(); ++i) {
      model::Joint& j = model_.joints[moving_[i]];
      if (!step.taken_by(j.env)) continue;
      const double rate = step.is_static ? 0 : step.integrator(j.env).rate(now[i], j.value, j.before) + j.ahead;
      j.rate_before = std::exchange(j.rate, rate), j.before = std::exchange(j.value, now[i]);
    }
  }

  void report(const FieldSinks& sinks, const Linearisation& at) override {
    if (!stopped_.empty()) {
      const std::vector<double> energy = energies_now(std::as_const(model_.q).view(), at, model_.envs);
      std::vector<std::uint8_t> has(model_.envs, 0);
      for (Index j : stopped_) has[model_.joints[j].env] = 1;
      for (Index e = 0; e < sinks.size(); ++e)
        if (has[e]) sinks[e].scalar("joint", "energy", "J", energy[e]);
    }
    for (Index j : moving_) {
      const model::Joint& joint = model_.joints[j];
      FieldSink& sink = sinks[joint.env];
      sink.scalar("joint", joint.name + (joint.type == model::JointType::prismatic ? "_travel" : "_angle"), joint.unit(), joint.value);
      sink.scalar("joint", joint.name + "_rate", std::string(joint.unit()) + "/s", joint.rate);
    }
    std::map<std::pair<Index, bool>, double> worst;  // by environment, and whether it slides
    for (Index j : moving_) {
      const model::Joint& joint = model_.joints[j];
      if (joint.leader < 0) continue;
      const model::Joint& leader = model_.joints[joint.leader];
      const double error = joint.value - joint.at_rest - joint.ratio * (leader.value - leader.at_rest);
      sinks[joint.env].scalar("joint", joint.name + "_mimic_error", joint.unit(), error);
      double& largest = worst[{joint.env, joint.type == model::JointType::prismatic}];
      largest = std::max(largest, std::abs(error));
    }
    for (const auto& [of, error] : worst) {
      if (of.second) sinks[of.first].scalar("joint", "mimic_error_mm", "mm", 1e3 * error);
      if (!of.second) sinks[of.first].scalar("joint", "mimic_error_deg", "deg", error * 180 / std::numbers::pi);
    }
    if (equations_.any()) equations_.report(sinks);
    for (std::size_t i = 0; i < stopped_.size(); ++i) {
      const model::Joint& joint = model_.joints[stopped_[i]];
      sinks[joint.env].scalar("joint", joint.name + "_stop", joint.effort_unit(), -stops_[i].first(joint.value));
    }
  }

  void checkpoint(Archive& archive) override {
    std::vector<Index> by_env(model_.joints.size()), env;
    std::iota(by_env.begin(), by_env.end(), 0);
    std::stable_sort(by_env.begin(), by_env.end(), [this](Index a, Index b) { return model_.joints[a].env < model_.joints[b].env; });
    for (Index j : by_env) env.push_back(model_.joints[j].env);
    for (const auto& [name, of] : {std::pair{"value", &model::Joint::value},
                                   {"before", &model::Joint::before},
                                   {"rate", &model::Joint::rate},
                                   {"rate_before", &model::Joint::rate_before}}) {
      std::vector<double> values;
      for (Index j : by_env) values.push_back(model_.joints[j].*of);
      archive.io(name, values, firsts(env, model_.envs));
      if (values.size() != by_env.size())
        throw Error(Exit::file, "the checkpoint belongs to another scene: it has " + std::to_string(values.size()) + " joints");
      for (std::size_t i = 0; i < values.size(); ++i) model_.joints[by_env[i]].*of = values[i];
    }
    equations_.checkpoint(archive);
  }

  // The coordinates that there are.
  device::Buffer<model::Coordinate> those_that_move() const {
    std::vector<model::Coordinate> list;
    for (Index j : moving_) list.push_back(model::coordinate_of(model_, model_.joints[j]));
    return device::Buffer<model::Coordinate>(list);
  }

  // Their rates, where the blocks are at q and move with v.
  std::vector<double> rates_of(Positions q, Positions v) const {
    const device::Buffer<model::Coordinate> all = those_that_move();
    device::Buffer<double> rate(all.size());
    const View<double> out = rate.view();
    const View<const model::Coordinate> of = all.view();
    device::parallel_for("joint.rates", out.n, [=] MORTISE_HD(Index i) {
      out[i] = model::coordinate_rate(of[i], model::reading(of[i], q), model::reading(of[i], v, true));
    });
    return rate.download();
  }

  // Of all joints that have one, at q; turns counted from the accepted state.
  std::vector<double> coordinates(Positions q) const {
    const device::Buffer<model::Coordinate> all = those_that_move();
    device::Buffer<double> value(all.size());
    const View<double> out = value.view();
    const View<const model::Coordinate> of = all.view();
    device::parallel_for("joint.coordinates", out.n, [=] MORTISE_HD(Index i) { out[i] = model::coordinate(of[i], model::reading(of[i], q)); });
    return value.download();
  }

 private:
  void upload() {
    if (stopped_.empty()) return;
    std::vector<CoordinateEnergy<stop::Stops>::Item> items;
    for (std::size_t i = 0; i < stopped_.size(); ++i) {
      const model::Joint& j = model_.joints[stopped_[i]];
      items.push_back({model::coordinate_of(model_, j), stops_[i]});
    }
    energy_.upload(items);
  }

  // The weight of all bodies there at a lever of the larger of the two: what a stop may have to bear at most, in order of magnitude [N m]; of a slide
  // the weight itself [N].
  double usual_effort(const model::Joint& j) const {
    const joint::Usual usual = joint::usual(model_, j);
    return usual.weight() * (j.type == model::JointType::prismatic ? 1 : usual.lever);
  }

  model::Model& model_;
  std::vector<Index> moving_, stopped_;  // joints that have a coordinate, and those that have stops, by environment
  std::vector<stop::Stops> stops_;
  CoordinateEnergy<stop::Stops> energy_;
  joint::Equations equations_;
  Integrator integrator_;  // of the step under way; its dt is 0 in statics
  // Mended by a share: accelerations of the leader in its last two steps, and how many of them there are.
  struct Led {
    double a = 0, a_before = 0;
  };
  double mended_ = 0;
  std::vector<Led> led_;
  int known_ = 0;
};

}  // namespace

const Kind& joint_kind() {
  static const Kind kind{"joint",
                         Role::tie,
                         "stiff bodies hang together by joints",
                         &joint::table,
                         [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<Joints>(p, m); },
                         {"Chen, Diaz, Lan, Yang, Kaufman, Sifakis: A Unified Newton Barrier Method for Multibody Dynamics. ACM TOG 41(4), 2022"}};
  return kind;
}

const Kind& Joints::kind() const { return joint_kind(); }

}  // namespace mortise::effects
