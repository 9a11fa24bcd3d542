#include "audit/holds.h"

#include <algorithm>
#include <cmath>

#include "audit/entries.h"
#include "audit/tuning.h"
#include "effects/joint/stop.h"
#include "effects/tie_name.h"

namespace mortise::audit {

namespace {

double number_or(const Params& p, const char* key, double otherwise) { return p.has(key) ? p.number(key) : otherwise; }
double reported(const Holds::State& state, const std::string& name) {
  const auto it = state.number.find(name);
  return it == state.number.end() ? 0 : it->second;
}

}  // namespace

Holds::Holds(const Params& effects) {
  for (const Params& p : entries(effects, "joint")) {
    Joint j;
    j.name = effects::tie_name(p), j.body = p.text("body"), j.to = p.has("to") ? p.text("to") : "";
    const std::string& type = p.text("type");
    j.spherical = type == "spherical", j.fixed = type == "fixed", j.slides = type == "prismatic";
    if (p.has("at")) j.at = p.vec3("at");
    if (p.has("axis")) j.axis = p.vec3("axis").normalized();
    if (const Params* mimic = p.find("mimic")) j.leader = mimic->text("joint"), j.ratio = number_or(*mimic, "ratio", 1);
    if (const Params* limits = p.find(j.slides ? "travel_limits" : "angle_limits")) j.low = limits->as_numbers()[0], j.high = limits->as_numbers()[1];
    by_name_[j.name] = joints_.size(), joints_.push_back(j);
    if (!j.to.empty()) together_.emplace_back(j.body, j.to);
  }
  for (const Params& p : entries(effects, "drive")) {
    Motor& m = motors_[p.text("joint")];
    const std::string& mode = p.text("mode");
    m.kinematic = mode == "kinematic", m.passive = mode == "passive", m.effort_only = mode == "effort";
    m.kp = number_or(p, "kp", 0), m.kd = number_or(p, "kd", 0), m.effort = number_or(p, "effort", INFINITY), m.spring = number_or(p, "stiffness", 0);
    m.damping = number_or(p, "damping", 0), m.armature = number_or(p, "armature", 0);
  }
  struct Link {
    std::string body, to;
  };
  std::vector<Link> bonds, ties;
  for (const Params& p : entries(effects, "bond")) bonds.push_back({p.text("body"), p.text("to")});
  for (const Params& p : entries(effects, "mortar_tie")) ties.push_back({p.text("body"), p.text("to")});
  for (const std::vector<Link>* links : {&bonds, &ties})
    for (const Link& l : *links) together_.emplace_back(l.body, l.to);

  // From what is held outwards, nearest first.
  std::vector<std::string> reached;
  const auto reach = [&](const std::string& body, Step by) {
    if (ways_.emplace(body, std::move(by)).second) reached.push_back(body);
  };
  for (const Params& pin : entries(effects, "pin"))
    if (!pin.has("release")) reach(pin.text("body"), {});
  for (std::size_t i = 0; i < joints_.size(); ++i)
    if (joints_[i].to.empty()) reach(joints_[i].body, {"", static_cast<long>(i)});
  for (std::size_t next = 0; next < reached.size(); ++next) {
    const std::string from = reached[next];
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      if (joints_[i].to == from) reach(joints_[i].body, {from, static_cast<long>(i)});
      if (joints_[i].body == from && !joints_[i].to.empty()) reach(joints_[i].to, {from, static_cast<long>(i)});
    }
    for (const Link& l : bonds)
      if (l.to == from) reach(l.body, {from});
    for (const Link& l : ties) {
      if (l.to == from) reach(l.body, {from, -1, true});
      if (l.body == from) reach(l.to, {from, -1, true});
    }
  }
}

bool Holds::pinned(const std::string& body) const {
  const auto it = ways_.find(body);
  return it != ways_.end() && it->second.to.empty() && it->second.joint < 0;
}

bool Holds::each_joint(const std::string& body, const std::function<bool(const Joint&)>& passes) const {
  for (const std::string* at = &body; !at->empty();) {
    const Step& step = ways_.at(*at);
    if (step.joint >= 0 && !passes(joints_[step.joint])) return false;
    at = &step.to;
  }
  return true;
}

const Holds::Motor* Holds::motor(const Joint& joint) const {
  const auto it = motors_.find(leader(joint).first->name);
  return it == motors_.end() ? nullptr : &it->second;
}

bool Holds::given(const std::string& body) const {
  return held(body) && each_joint(body, [&](const Joint& joint) {
           const Motor* m = motor(joint);
           return joint.fixed || (m && m->kinematic);
         });
}

bool Holds::goes_by_gains(const std::string& body) const {
  return held(body) && !given(body) && each_joint(body, [&](const Joint& joint) {
           const Motor* m = motor(joint);
           return joint.fixed || (m && (m->kinematic || m->swings()));
         });
}

bool Holds::motored(const std::string& body) const {
  if (!held(body)) return false;
  for (const std::string* at = &body; !at->empty() && !given(*at);) {
    const Step& step = ways_.at(*at);
    if (step.joint >= 0 && driven(joints_[step.joint].name) != Driven::no) return true;
    at = &step.to;
  }
  return false;
}

Holds::Driven Holds::driven(const std::string& joint) const {
  const auto named = by_name_.find(joint);
  const Motor* m = named == by_name_.end() ? nullptr : motor(joints_[named->second]);
  if (!m || m->passive) return Driven::no;
  return m->effort_only ? Driven::by_effort : Driven::yes;
}

bool Holds::damped(const std::string& body, double step) const {
  if (!held(body)) return false;
  const Motor* first = nullptr;
  each_joint(body, [&](const Joint& joint) {
    if (joint.fixed) return true;
    first = motor(joint);
    return false;
  });
  return first && first->kp + first->spring > 0 && first->kd + first->damping > tuning::kDamped * step * (first->kp + first->spring);
}

std::pair<const Holds::Joint*, double> Holds::leader(const Joint& joint) const {
  std::pair<const Joint*, double> out{&joint, 1};
  for (std::size_t turns = 0; !out.first->leader.empty() && turns < joints_.size(); ++turns)
    out.second *= out.first->ratio, out.first = &joints_[by_name_.at(out.first->leader)];
  return out;
}

const std::string* Holds::tied_to(const std::string& body) const {
  const auto it = ways_.find(body);
  return it != ways_.end() && it->second.tie ? &it->second.to : nullptr;
}

double Holds::stop(const Joint& joint, const State& state) const {
  const double force = std::abs(reported(state, "joint/" + joint.name + "_stop")),
               x = reported(state, "joint/" + joint.name + (joint.slides ? "_travel" : "_angle"));
  namespace stops = effects::joint::tuning;
  const double range = std::min(joint.slides ? stops::kSlide : stops::kTurn, stops::kShare * (joint.high - joint.low));
  const double t = std::min(x - joint.low, joint.high - x) / range;
  if (!(force > 0 && t > 0 && t < 1)) return 0;
  return force / effects::stop::phi(t) * effects::stop::phi_falls(t) / range;
}

// K of a coordinate; `moment` of the load about it.
double Holds::stiffness(const Joint& joint, double moment, const Load& load, const State& state) const {
  const double stop = this->stop(joint, state);
  const auto it = motors_.find(joint.name);
  if (it == motors_.end()) return stop;
  const Motor& m = it->second;
  if (m.kinematic) return INFINITY;
  const double wanted = std::abs(m.kp * reported(state, "drive/" + joint.name + "_error") + m.kd * reported(state, "joint/" + joint.name + "_rate"));
  const double on = moment == 0 ? 0 : load.gap * load.force.norm() / std::abs(moment);  // the way of the coordinate for that of the gap
  return m.spring + stop + (wanted - m.kp * on >= m.effort ? 0 : m.kp);
}

void Holds::each_standing(const std::string& body, const Motions& motion, const std::function<bool(const Standing&)>& look) const {
  for (const std::string* at = &body; !at->empty();) {
    const Step& step = ways_.at(*at);
    if (step.joint >= 0) {
      const Joint& joint = joints_[step.joint];
      const geometry::Motion carried = joint.to.empty() ? geometry::Motion{} : motion(joint.to);
      if (!look({joint, carried.R * joint.at + carried.t, carried.R * joint.axis, joint.body == *at ? 1.0 : -1.0})) return;
    }
    at = &step.to;
  }
}

std::map<std::string, geometry::RigidVelocity> Holds::moved_by(const std::string& body, const Motions& motion, const Vec3& centre) const {
  std::map<std::string, geometry::RigidVelocity> out;
  each_standing(body, motion, [&](const Standing& s) {
    if (!s.joint.has_coordinate()) return true;
    const auto [leader, ratio] = this->leader(s.joint);
    geometry::RigidVelocity& of = out[leader->name];
    const Vec3 axis = s.side * ratio * s.axis;
    of.centre = centre;
    of.v += s.joint.slides ? axis : axis.cross(centre - s.place);
    if (!s.joint.slides) of.w += axis;
    return true;
  });
  return out;
}

Holds::Give Holds::give(const std::string& body, const Load& load, const State& state) const {
  const double force = load.force.norm();
  std::map<std::string, Coordinate> led;  // by the joint that leads
  bool loose = false;
  each_standing(body, state.motion, [&](const Standing& s) {
    const Vec3 moment = load.moment - s.place.cross(load.force);
    const double size = state.distance(body, s.place);
    loose = s.joint.spherical && moment.norm() > tuning::kOneWay * force * size;
    if (loose || !s.joint.has_coordinate()) return !loose;
    // The load is on the side of `body`, or on that of `to`.
    const double along = s.side * s.axis.dot(s.joint.slides ? load.force : moment);
    const auto [leader, ratio] = this->leader(s.joint);
    Coordinate& c = led[leader->name];
    c.moment += ratio * along, c.size = std::max(c.size, std::abs(ratio) * (s.joint.slides ? 1 : size));
    if (const auto motor = motors_.find(s.joint.name); leader != &s.joint && motor != motors_.end()) c.spring += ratio * ratio * motor->second.spring;
    return true;
  });
  if (loose) return {INFINITY, 0};
  double work = 0;
  for (const auto& [name, c] : led) {
    const double K = c.spring + stiffness(joints_[by_name_.at(name)], c.moment, load, state);
    if (K > 0)
      work += c.moment * c.moment / K;
    else if (std::abs(c.moment) > tuning::kOneWay * force * c.size)
      return {INFINITY, c.moment / c.size};
  }
  return {force > 0 ? work / force : 0, 0};
}

}  // namespace mortise::audit
