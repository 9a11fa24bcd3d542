#include "effects/drive/gait.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "effects/drive/tuning.h"
#include "model/model.h"

namespace mortise::effects::drive {

using param::of;
constexpr double kPi = std::numbers::pi;

const ParamTable gait_table{
    "drive gait",
    "Steps of a leg of two parallel hinges, from where its foot stands in the scene; the drives of both have the same block.",
    {param::required(of(Param::Kind::text, "upper", Unit::none, std::nullopt, "Name of the leg's upper hinge (hip, thigh).")),
     param::required(of(Param::Kind::text, "lower", Unit::none, std::nullopt, "Of its lower one (knee, calf); it shares a body with the upper one.")),
     param::required(of(Param::Kind::vec3, "foot", Unit::length, std::nullopt, "Where the foot stands in the scene, world coordinates.")),
     param::positive(param::required(of(Param::Kind::number, "period", Unit::time, std::nullopt, "Of a cycle."))),
     param::required(
         of(Param::Kind::number, "stride", Unit::length, std::nullopt, "Way of the foot along the ground while it stands; below zero: backwards.")),
     param::required(param::number("clearance", Unit::length, "", 0, "Height of the swinging foot above where it stands.")),
     param::number("depth", Unit::length, "0 mm", 0, "How much further down the foot reaches in the middle of its stance."),
     [] {
       Param p = param::range(of(Param::Kind::number, "duty", Unit::none, "0.55", "Share of a cycle that the foot stands."), 0, 1);
       p.min_open = p.max_open = true;
       return p;
     }(),
     param::range(of(Param::Kind::number, "phase", Unit::none, "0", "Share of a cycle by which this leg is ahead of one of phase 0."), 0, 1),
     param::number("begin", Unit::time, "0 s", 0, "When it starts; the foot stands before that."),
     param::number("ramp", Unit::time, "0.5 s", 0, "Over which stride, clearance and depth grow to what they are."),
     of(Param::Kind::vec3, "forward", Unit::none, "[1, 0, 0]", "Where it walks to, world coordinates at rest."),
     of(Param::Kind::vec3, "up", Unit::none, "[0, 0, 1]", "Away from the ground.")}};

Gait::Gait(const Params& b, const model::Model& model, Index joint)
    : period_(b.number("period")),
      duty_(b.number("duty")),
      stride_(b.number("stride")),
      clearance_(b.number("clearance")),
      depth_(b.number("depth")),
      phase_(b.number("phase")),
      begin_(b.number("begin")),
      ramp_(b.number("ramp")) {
  const model::Joint& mine = model.joints[joint];
  const auto hinge = [&](const char* key) -> const model::Joint& {
    for (const Index j : model::joints_named(model, b.text(key), b.at(key).where()))
      if (model.joints[j].env == mine.env && model.joints[j].type == model::JointType::revolute) return model.joints[j];
    throw Error(Exit::scene, b.at(key).where(), "'" + b.text(key) + "' is no hinge: a leg has two revolute joints");
  };
  const model::Joint &upper = hinge("upper"), &lower = hinge("lower");
  if (&mine != &upper && &mine != &lower)
    throw Error(
        Exit::scene, b.where(),
        "the gait of '" + mine.name + "' is that of '" + upper.name + "' and '" + lower.name + "': one of them has to be the joint that is driven");
  // The thigh is what both hinges have; each counts its angle of `body` against `to`.
  const Index thigh = upper.body == lower.to || upper.body == lower.body ? upper.body : upper.to;
  if (&upper == &lower || (thigh != lower.to && thigh != lower.body) || thigh == model::Tie::kWorld)
    throw Error(Exit::scene, b.at("lower").where(),
                "'" + lower.name + "' does not hang on what '" + upper.name + "' turns: a leg is hip, thigh, knee, shank");
  const Vec3 a = upper.axis;
  if (a.cross(lower.axis).norm() > tuning::kParallel)
    throw Error(Exit::scene, b.at("lower").where(),
                "the axes of '" + upper.name + "' and '" + lower.name + "' are not parallel: a leg's knee bends in one plane");
  const auto across = [&](const char* key) -> Vec3 {
    const Vec3 d = b.vec3(key);
    if (!(d.norm() > 0) || std::abs(d.normalized().dot(a)) > tuning::kAcross)
      throw Error(Exit::scene, b.at(key).where(),
                  std::string(key) + " points along the axis of '" + upper.name + "': the leg does not swing that way");
    return (d - d.dot(a) * a).normalized();
  };
  const Vec3 e1 = across("forward"), e2 = a.cross(e1);
  const auto plane = [&](const Vec3& v) { return Complex(v.dot(e1), v.dot(e2)); };
  forward_ = plane(e1), up_ = plane(across("up"));
  thigh_ = plane(lower.place - upper.place), shank_ = plane(b.vec3("foot") - lower.place);
  bend_ = std::arg(shank_ / thigh_);
  if (!(std::abs(thigh_) > 0) || !(std::abs(shank_) > 0) || !(std::abs(std::sin(bend_)) > tuning::kStraight))
    throw Error(Exit::scene, b.at("foot").where(),
                "the leg from '" + upper.name + "' over '" + lower.name +
                    "' to its foot is straight: let it stand bent, so that it is known which way its knee goes");
  upper_ = &mine == &upper;
  stands_ = mine.at_rest;
  sense_ = upper_ ? (upper.body == thigh ? 1 : -1) : (lower.to == thigh ? 1 : -1) * (a.dot(lower.axis) > 0 ? 1 : -1);
  check(b);
}

Gait::Complex Gait::way(double s, double r) const {
  s -= std::floor(s);
  if (s < duty_) {
    const double u = s / duty_;
    return r * (stride_ * (0.5 - u) * forward_ - depth_ * std::sin(kPi * u) * up_);
  }
  const double u = (s - duty_) / (1 - duty_);
  return r * (stride_ * (u - std::sin(2 * kPi * u) / (2 * kPi) - 0.5) * forward_ + 0.5 * clearance_ * (1 - std::cos(2 * kPi * u)) * up_);
}

double Gait::turn(const Complex& way) const {
  const Complex foot = thigh_ + shank_ + way;
  const double l1 = std::abs(thigh_), l2 = std::abs(shank_), c = (std::norm(foot) - l1 * l1 - l2 * l2) / (2 * l1 * l2);
  const double l = std::copysign(std::acos(std::clamp(c, -1.0, 1.0)), bend_) - bend_;
  return upper_ ? std::arg(foot / (thigh_ + shank_ * std::polar(1.0, l))) : l;
}

double Gait::operator()(double t) const {
  const double walked = std::max(0.0, t - begin_), v = ramp_ > 0 ? std::min(1.0, walked / ramp_) : walked > 0 ? 1 : 0;
  return stands_ + sense_ * turn(way(phase_ + 0.5 * duty_ + walked / period_, v * v * (3 - 2 * v)));
}

// Does the leg reach all of the path, and each that is smaller?
void Gait::check(const Params& b) const {
  const double least = std::abs(std::abs(thigh_) - std::abs(shank_)), most = std::abs(thigh_) + std::abs(shank_);
  for (int k = 0; k < tuning::kSamples; ++k)
    for (const double r : {0.25, 0.5, 0.75, 1.0}) {
      const double s = static_cast<double>(k) / tuning::kSamples, reach = std::abs(thigh_ + shank_ + way(s, r));
      if (least < reach && reach < most) continue;
      std::ostringstream why;
      why.precision(4);
      why << "the steps are too large for the leg: at " << 100 * s << " % of its cycle the foot is to be " << reach << " m from '" << b.text("upper")
          << "', and it can be from " << (least > 1e-9 ? least : 0) << " to " << most << " m; less stride, clearance or depth";
      throw Error(Exit::scene, b.where(), why.str());
    }
}

}  // namespace mortise::effects::drive
