#include "effects/joint/joint.h"

#include <algorithm>
#include <utility>

#include "effects/hinge_energy.h"
#include "effects/joint/read.h"
#include "effects/joint/stop.h"

namespace mortise::effects {
namespace {

class Joints final : public Effect {
 public:
  Joints(const Params& list, model::Model& model) : model_(model) {
    joint::Read read = joint::read(list, model);
    const auto first = static_cast<Index>(model.ties.list().size());
    for (model::Joint& j : read.joints) j.tie += first;
    model.ties.add(model, std::move(read.ties));
    model.joints = std::move(read.joints);
    std::vector<Index> env;
    std::vector<model::Hinge> hinges;
    for (Index e = 0; e < model.envs; ++e)
      for (std::size_t j = 0; j < model.joints.size(); ++j) {
        const model::Joint& joint = model.joints[j];
        if (joint.env != e || !joint.has_coordinate()) continue;
        turning_.push_back(static_cast<Index>(j));
        hinges.push_back(hinge_of(model, joint));
        if (!std::isfinite(joint.low)) continue;
        stopped_.push_back(static_cast<Index>(j)), env.push_back(e);
        stops_.push_back({joint.low, joint.high, std::min(stop::kRange, stop::kShare * (joint.high - joint.low)), read.stop_effort[j] > 0 ? read.stop_effort[j] : usual_effort(joint)});
      }
    hinges_.upload(hinges);
    energy_.set_environments(env, model.envs);
    upload();
  }

  const Kind& kind() const override;
  std::vector<PlanItem> plan() const override {
    std::vector<PlanItem> out = tie_plan("joint", model_);
    if (!stopped_.empty()) out.push_back({"stops", energy_.bytes()});
    return out;
  }
  std::unique_ptr<Linearisation> linearisation() const override { return std::make_unique<HingeLinearisation>(); }

  void begin_step(const StepInfo&) override { upload(); }
  void energy(Positions q, const Linearisation&, device::EnvValues per_env) override { energy_.energy("joint.energy", q, per_env); }
  void linearise(Positions q, Want want, Linearisation& at) override { energy_.linearise("joint.assemble", model_, q, want, at); }
  void max_step(View<const Vec3> dq, Linearisation& at, device::EnvValues alpha) override { energy_.max_step("joint.max_step", dq, at, alpha); }

  void end_step(const StepInfo& step, Positions q, const Linearisation&) override {
    const std::vector<double> now = angles(q);
    for (std::size_t i = 0; i < turning_.size(); ++i) {
      model::Joint& j = model_.joints[turning_[i]];
      if (!step.taken_by(j.env)) continue;
      const double value = model::unwrapped(j.at_rest + now[i], j.value);
      j.rate = step.is_static ? 0 : (value - j.value) / step.dt;
      j.value = value;
    }
  }

  void report(FieldSink& sink, const Linearisation& at) override {
    if (!stopped_.empty()) sink.scalar("joint", "energy", "J", energy_now(std::as_const(model_.q).view(), at, model_.envs));
    for (Index j : turning_) {
      const model::Joint& joint = model_.joints[j];
      sink.scalar("joint", joint.name + "_angle", "rad", joint.value);
      sink.scalar("joint", joint.name + "_rate", "rad/s", joint.rate);
    }
    for (std::size_t i = 0; i < stopped_.size(); ++i) {
      const model::Joint& joint = model_.joints[stopped_[i]];
      sink.scalar("joint", joint.name + "_stop", "N m", -stops_[i].first(joint.value));
    }
  }

  void checkpoint(Archive& archive) override {
    std::vector<double> value, rate;
    for (const model::Joint& j : model_.joints) value.push_back(j.value), rate.push_back(j.rate);
    archive.io("value", value);
    archive.io("rate", rate);
    if (!archive.loading()) return;
    if (value.size() != model_.joints.size() || rate.size() != value.size()) throw Error(Exit::file, "the checkpoint belongs to another scene: it has " + std::to_string(value.size()) + " joints");
    for (std::size_t j = 0; j < value.size(); ++j) model_.joints[j].value = value[j], model_.joints[j].rate = rate[j];
  }

  // Of all hinges at q, counted from rest, in (-pi, pi].
  std::vector<double> angles(Positions q) const {
    device::Buffer<double> angle(hinges_.size());
    const View<double> out = angle.view();
    const View<const model::Hinge> hinge = hinges_.view();
    device::parallel_for("joint.angles", out.n, [=] MORTISE_HD(Index i) { out[i] = model::hinge_angle(model::directions(hinge[i], q)); });
    return angle.download();
  }

 private:
  void upload() {
    if (stopped_.empty()) return;
    std::vector<HingeEnergy<stop::Stops>::Item> items;
    for (std::size_t i = 0; i < stopped_.size(); ++i) {
      const model::Joint& j = model_.joints[stopped_[i]];
      items.push_back({{hinge_of(model_, j), j.at_rest, j.value}, stops_[i]});
    }
    energy_.upload(items);
  }

  // The weight of all bodies there at a lever of the larger of the two: what a stop may have to bear at most, in order of magnitude [N m].
  double usual_effort(const model::Joint& j) const {
    constexpr double kGravity = 9.81;
    double mass = 0, lever = 0;
    const std::vector<Vec3> rest = model_.rest_points.download();
    for (std::size_t b = 0; b < model_.bodies.size(); ++b) {
      const model::Body& body = model_.bodies[b];
      if (body.env != j.env) continue;
      mass += body.mass;
      if (static_cast<Index>(b) != j.body && static_cast<Index>(b) != j.to) continue;
      for (Index p = body.point_begin; p < body.point_end; ++p) lever = std::max(lever, (rest[p] - j.place).norm());
    }
    return kGravity * mass * lever;
  }

  model::Model& model_;
  std::vector<Index> turning_, stopped_;  // joints that have an angle, and those that have stops, by environment
  std::vector<stop::Stops> stops_;
  HingeEnergy<stop::Stops> energy_;
  device::Buffer<model::Hinge> hinges_;
};

}  // namespace

const Kind& joint_kind() {
  static const Kind kind{"joint", Role::tie, "stiff bodies hang together by joints", &joint::table,
          [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<Joints>(p, m); },
          {"Chen, Diaz, Lan, Yang, Kaufman, Sifakis: A Unified Newton Barrier Method for Multibody Dynamics. ACM TOG 41(4), 2022"}};
  return kind;
}

const Kind& Joints::kind() const { return joint_kind(); }

}  // namespace mortise::effects
