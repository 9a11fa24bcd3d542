#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <sstream>
#include <utility>

#include "base/complaints.h"
#include "effects/commanded.h"
#include "effects/coordinate_energy.h"
#include "effects/drive/entry.h"
#include "effects/drive/law.h"
#include "effects/failure.h"
#include "effects/list.h"
#include "effects/per_environment.h"

namespace mortise::effects {
namespace {

using drive::Entry;
using drive::Law;
using drive::Mode;

// A joint that an entry drives. Of the accepted state: what is reported.
struct Driven {
  Index entry, joint;
  double ratio = 1, offset = 0;             // of what the entry aims at: joints that mimic a given one are given too
  double target = 0, torque = 0, drag = 0;  // [rad, m] or [N m, N], [N m, N]
  double held = 0;                          // [J]
  double stick = 0;                         // what its dry friction holds (law.h), in creep distances
  Law law{};                                // of the step under way
};

class Drive final : public Effect, public Commanded {
 public:
  Drive(const Params& list, model::Model& model) : model_(model) {
    const Params& time = model.input.scene.at("time");
    is_static_ = time.text("mode") == "static";
    std::set<Index> taken;
    Complaints wrong;
    const auto read = [&](std::size_t i) {
      const Params& p = list.items()[i];
      for (Index j : model::joints_named(model, p.text("joint"), p.at("joint").where())) {
        const Params& own = model.input.effect_of(list, model.joints[j].env).items()[i];
        entries_.push_back(drive::read(own, is_static_, model, j));
        const model::Joint& joint = model.joints[j];
        if (!joint.has_coordinate())
          throw Error(Exit::scene, p.at("joint").where(), "'" + joint.name + "' has nothing to drive: it is neither revolute nor prismatic");
        if (!taken.insert(j).second) throw Error(Exit::scene, p.at("joint").where(), "'" + joint.name + "' has a drive already");
        const auto entry = static_cast<Index>(entries_.size()) - 1;
        if (entries_.back().mode == Mode::kinematic)
          hand_over({entry, j}, time);
        else
          motors_.push_back({entry, j});
      }
    };
    for (std::size_t i = 0; i < list.items().size(); ++i) wrong.gather([&] { read(i); });
    wrong.raise();
    std::stable_sort(motors_.begin(), motors_.end(),
                     [&](const Driven& a, const Driven& b) { return model.joints[a.joint].env < model.joints[b.joint].env; });
    std::vector<Index> env;
    for (const Driven& d : motors_) env.push_back(model.joints[d.joint].env);
    energy_.set_environments(env, model.envs);
    for (std::vector<Driven>* all : {&motors_, &given_})
      for (Driven& d : *all) d.target = d.ratio * entries_[d.entry].target(0) + d.offset;
    upload();
  }

  const Kind& kind() const override;
  std::vector<PlanItem> plan() const override { return {{"motors", energy_.bytes()}}; }
  std::unique_ptr<Linearisation> linearisation() const override { return std::make_unique<CoordinateLinearisation>(); }

  void command(const std::vector<model::Command>& commands) override {
    commands_.clear();
    for (const model::Command& c : commands) commands_.emplace(c.joint, c);
  }

  void connect() override { remember(); }
  void begin_step(const StepInfo& step) override {
    for (Driven& d : motors_) {
      const Entry& e = entries_[d.entry];
      const model::Joint& j = model_.joints[d.joint];
      if (!step.taken_by(j.env)) continue;
      d.target = wanted(d, step.t1_of(j.env));
      d.law = {};
      const Integrator of = is_static_ ? backward_euler(1) : step.integrator(j.env);
      d.law.h = of.dt, d.law.pace = of.a0 / of.dt, d.law.drift = of.rate(j.value, j.value, j.before);
      d.law.effort = e.effort, d.law.velocity = e.velocity, d.law.damping = e.damping, d.law.dry = e.friction;
      d.law.stiffness = e.stiffness, d.law.stretch = j.value - e.rest;
      d.law.armature = e.armature, d.law.rate = (of.a1 * j.rate - of.a2 * j.rate_before) / of.a0;
      d.law.creep = j.type == model::JointType::prismatic ? drive::tuning::kCreepSlide : drive::tuning::kCreep;
      d.law.stick = d.stick * d.law.creep * d.law.h;
      if (e.mode == Mode::pd)
        d.law.kp = e.kp, d.law.aim = d.target - j.value, d.law.a = e.kp * d.law.aim - e.kd * d.law.drift, d.law.K = e.kp + e.kd * d.law.pace;
      if (e.mode == Mode::effort) d.law.a = d.target;
    }
    upload();
    if (!given_.empty()) turn(step);
  }

  void mend(Fault fault, double share) override {
    if (fault == Fault::steps && !is_static_) mended_ = share != 0;
  }
  // Joints know by how much their rates and accelerations are more.
  void keep_pace(const Effect&, Positions) override {
    if (!mended_) return;
    for (Driven& d : motors_) {
      const Entry& e = entries_[d.entry];
      const model::Joint& j = model_.joints[d.joint];
      d.law.a -= e.kd * j.ahead;
      d.law.left += e.damping * j.ahead + e.armature * j.behind;
    }
    upload();
  }

  void energy(Positions q, const Linearisation&, device::EnvValues per_env) override { energy_.energy("drive.energy", q, per_env); }
  void linearise(Positions q, Want want, Linearisation& at) override { energy_.linearise("drive.assemble", model_, q, want, at); }
  void max_step(View<const Vec3> dq, Linearisation& at, device::EnvValues alpha) override { energy_.max_step("drive.max_step", dq, at, alpha); }

  void held_energy(Positions q, Positions move, device::Fetch& fetch, Held& all) override {
    for (std::vector<double>* sums : {&all.at_last, &all.begin, &all.end, &all.along}) sums->assign(static_cast<std::size_t>(model_.envs), 0.0);
    for (std::size_t i = 0; i < motors_.size(); ++i) {
      const Index env = model_.joints[motors_[i].joint].env;
      all.at_last[env] += motors_[i].held, all.begin[env] += held(motors_[i]);
    }
    energy_.stored("drive.stored", q, move, {all.end, fetch}, {all.along, fetch});
  }

  // Joints know where they are by now; the way of the step is that from where the law began.
  void end_step(const StepInfo& step, Positions, const Linearisation&) override {
    for (std::size_t i = 0; i < motors_.size(); ++i) {
      Driven& d = motors_[i];
      const model::Joint& j = model_.joints[d.joint];
      if (!step.taken_by(j.env)) continue;
      const double way = j.value - begin_[i];
      d.torque = d.law.motor(way), d.drag = -d.law.drag(way), d.held = held(d);
      d.stick = std::clamp((way + d.law.stick) / (d.law.creep * d.law.h), -1.0, 1.0);
    }
  }

  void report(const FieldSinks& sinks, const Linearisation&) override {
    const auto put = [&](const model::Joint& j, const char* what, const char* unit, double v) {
      sinks[j.env].scalar("drive", j.name + "_" + what, unit, v);
    };
    for (const std::vector<Driven>* all : {&motors_, &given_})
      for (const Driven& d : *all) {
        const Entry& e = entries_[d.entry];
        const model::Joint& j = model_.joints[d.joint];
        if (e.mode == Mode::pd || e.mode == Mode::kinematic) put(j, "target", j.unit(), d.target), put(j, "error", j.unit(), j.value - d.target);
        if (e.mode == Mode::kinematic) continue;  // its torque is that of its tie
        if (e.mode != Mode::passive)
          put(j, j.type == model::JointType::prismatic ? "force" : "torque", j.effort_unit(), d.torque), put(j, "power", "W", d.torque * j.rate);
        if (e.drags()) put(j, "drag", j.effort_unit(), d.drag);
      }
    report_tracking(sinks);
    std::vector<double> energy(static_cast<std::size_t>(model_.envs), 0.0);
    std::vector<char> any(energy.size(), 0);
    for (const Driven& d : motors_) {
      const Index env = model_.joints[d.joint].env;
      energy[env] += d.held, any[env] |= entries_[d.entry].holds();
    }
    for (Index e = 0; e < model_.envs; ++e)
      if (any[e]) sinks[e].scalar("drive", "energy", "J", energy[e]);
  }

  // The largest of all errors, in the units that people think of robots in.
  void report_tracking(const FieldSinks& sinks) const {
    std::vector<double> worst[2];
    for (std::vector<double>& w : worst) w.assign(static_cast<std::size_t>(model_.envs), -1);
    for (const std::vector<Driven>* all : {&motors_, &given_})
      for (const Driven& d : *all) {
        const model::Joint& j = model_.joints[d.joint];
        const Mode mode = entries_[d.entry].mode;
        if (mode != Mode::pd && mode != Mode::kinematic) continue;
        double& w = worst[j.type == model::JointType::prismatic][j.env];
        w = std::max(w, std::abs(j.value - d.target));
      }
    for (Index e = 0; e < model_.envs; ++e) {
      if (worst[0][e] >= 0) sinks[e].scalar("drive", "tracking_error_deg", "deg", worst[0][e] * 180 / std::numbers::pi);
      if (worst[1][e] >= 0) sinks[e].scalar("drive", "tracking_error_mm", "mm", 1e3 * worst[1][e]);
    }
  }

  void checkpoint(Archive& archive) override {
    std::vector<Driven*> drives;  // by environment
    for (std::vector<Driven>* all : {&motors_, &given_})
      for (Driven& d : *all) drives.push_back(&d);
    const auto env_of = [this](const Driven* d) { return model_.joints[d->joint].env; };
    std::stable_sort(drives.begin(), drives.end(), [&](const Driven* a, const Driven* b) { return env_of(a) < env_of(b); });
    std::vector<double> state;
    std::vector<Index> env;
    for (const Driven* d : drives) state.insert(state.end(), {d->target, d->torque, d->drag, d->stick}), env.push_back(env_of(d));
    archive.io("state", state, firsts(env, model_.envs, 4));
    if (!archive.loading()) return;
    if (state.size() != 4 * drives.size())
      throw Error(Exit::file, "the checkpoint belongs to another scene: it has " + std::to_string(state.size() / 4) + " drives");
    for (std::size_t i = 0; i < drives.size(); ++i) {
      const double* from = state.data() + 4 * i;
      Driven& d = *drives[i];
      d.target = from[0], d.torque = from[1], d.drag = from[2], d.stick = from[3];
    }
    remember();
    upload();
    place();
  }

 private:
  void remember() {
    for (Driven& d : motors_) d.held = held(d);
  }
  // In springs, in the rotor, and between where the joint is and the target of a motor with gains (law.h), of the state that joints are in [J].
  double held(const Driven& d) const {
    const Entry& e = entries_[d.entry];
    const model::Joint& j = model_.joints[d.joint];
    const double s = j.value - e.rest;
    return 0.5 * e.stiffness * s * s + 0.5 * e.armature * j.rate * j.rate + drive::limited_spring(e.kp, e.effort, d.target - j.value);
  }

  double wanted(const Driven& d, double t) const {
    const auto command = commands_.find(entries_[d.entry].joint);
    return d.ratio * (command != commands_.end() ? command->second.at(t) : entries_[d.entry].target(t)) + d.offset;
  }

  // A joint whose angle is given: the body that follows does so wholly. The target is checked as far as the scene's time goes.
  void hand_over(Driven d, const Params& time) {
    const model::Joint& j = model_.joints[d.joint];
    const Entry& e = entries_[d.entry];
    const std::string unit = std::string(" ") + j.unit();
    if (j.leader >= 0) throw Error(Exit::scene, e.where, "'" + j.name + "' mimics '" + model_.joints[j.leader].name + "': drive that one");
    if (std::abs(e.target(0) - j.at_rest) > drive::tuning::kSame) {
      std::ostringstream why;
      why << "the target of '" << j.name << "' begins at " << e.target(0) << unit << ", but the joint stands at " << j.at_rest << unit
          << ": begin there, or place its bodies otherwise and say so with the joint's '"
          << (j.type == model::JointType::prismatic ? "travel" : "angle") << "'";
      throw Error(Exit::scene, e.where, why.str());
    }
    give(d, time);
  }

  // And what mimics it.
  void give(const Driven& d, const Params& time) {
    const model::Joint& j = model_.joints[d.joint];
    const Entry& e = entries_[d.entry];
    const double h = is_static_ ? 1.0 / static_cast<double>(time.integer("steps")) : time.number("step");
    for (long long n = 0; n <= time.integer("steps") && std::isfinite(j.low); ++n) {
      const double wanted = d.ratio * e.target(h * static_cast<double>(n)) + d.offset;
      if (j.low < wanted && wanted < j.high) continue;
      std::ostringstream why;
      why << "the target of '" << j.name << "'" << (e.joint == j.name ? "" : ", which mimics '" + e.joint + "',") << " is " << wanted << " "
          << j.unit() << " at t = " << h * static_cast<double>(n) << ", beyond the limits of the joint, " << j.low << " and " << j.high << " "
          << j.unit();
      throw Error(Exit::scene, e.where, why.str());
    }
    if (!j.mimics) {
      given_.push_back(d);
      model_.ties.hand_over(model_, j.tie, "drive", model::placed_at(model_, j, j.at_rest), model::axis_of(model_, j),
                            j.type == model::JointType::prismatic);
    }
    for (std::size_t i = 0; i < model_.joints.size(); ++i) {
      const model::Joint& other = model_.joints[i];
      if (other.leader != d.joint) continue;
      give({d.entry, static_cast<Index>(i), other.ratio * d.ratio, other.at_rest + other.ratio * (d.offset - j.at_rest)}, time);
    }
  }

  // Points go straight from where they are to where they are asked to be, and what lies beside that way is not met: the same measure as for pins.
  void turn(const StepInfo& step) {
    using drive::tuning::kMostTurn;
    for (Driven& d : given_) {
      const model::Joint& j = model_.joints[d.joint];
      if (!step.taken_by(j.env)) continue;
      d.target = wanted(d, step.t1_of(j.env));
      if (j.type == model::JointType::prismatic || std::abs(d.target - j.value) <= kMostTurn) continue;
      std::ostringstream why;
      why << "the drive of '" << j.name << "' turns it by " << std::abs(d.target - j.value) << " rad in a step of " << step.dt
          << (step.is_static ? "" : " s") << "; it may be " << kMostTurn << " rad at most: take shorter steps";
      throw Failure{why.str(), j.env};
    }
    place();
  }
  void place() {
    std::vector<std::pair<Index, std::vector<model::Follow>>> follows;
    for (const Driven& d : given_) {
      const model::Joint& j = model_.joints[d.joint];
      follows.emplace_back(j.tie, model::placed_at(model_, j, d.target));
    }
    if (follows.empty()) return;
    model_.ties.drive(model_, std::move(follows));
    model::guide(model_);  // what slides on them
  }

  void upload() {
    std::vector<CoordinateEnergy<drive::At>::Item> items;
    begin_.clear();
    for (const Driven& d : motors_) {
      const model::Joint& j = model_.joints[d.joint];
      items.push_back({model::coordinate_of(model_, j), {j.value, d.law}});
      begin_.push_back(j.value);
    }
    energy_.upload(items);
  }

  model::Model& model_;
  bool is_static_ = false;
  bool mended_ = false;  // what finite steps leave out
  std::vector<Entry> entries_;
  std::vector<Driven> motors_, given_;              // by environment; those of mode kinematic
  std::map<std::string, model::Command> commands_;  // by joint; empty unless somebody outside drives
  std::vector<double> begin_;                       // where the joints of motors are at the beginning of the step [rad, m]
  CoordinateEnergy<drive::At> energy_;
};

}  // namespace

const Kind& drive_kind() {
  static const Kind kind = Kind{"drive", Role::motor, "motors of joints: PD, given torque or given angle; friction of bearings", &drive::table(),
                                [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<Drive>(p, m); }}
                               .differing_in({"kp", "kd", "effort", "velocity", "damping", "friction", "stiffness", "rest", "armature", "angle",
                                              "travel", "torque", "force", "sine", "gait"});
  return kind;
}

const Kind& Drive::kind() const { return drive_kind(); }

}  // namespace mortise::effects
