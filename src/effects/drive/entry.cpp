#include "effects/drive/entry.h"

#include <utility>

#include "base/error.h"
#include "model/model.h"

namespace mortise::effects::drive {
namespace {

using param::of;
using param::optional;

const ParamTable kDrive = [] {
  const auto si = [](const char* key, std::string help) { return optional(of(Param::Kind::number, key, Unit::any, std::nullopt, std::move(help))); };
  const auto least = [](Param p) { return param::range(std::move(p), 0, INFINITY); };
  ParamTable t{
      "effect drive",
      "Motors of joints, and what resists in their bearings.",
      {param::required(of(Param::Kind::text, "joint", Unit::none, std::nullopt, "Name of a revolute or prismatic joint.")),
       param::required(param::choice("mode", {"pd", "effort", "kinematic", "passive"}, "",
                                     "pd: torque kp (target - angle) - kd rate, within limits; effort: the given torque; kinematic: the "
                                     "angle is the target, exactly; passive: no motor. Of prismatic joints forces and travel, in N and m.")),
       param::positive(si("kp", "Stiffness of mode pd [N m/rad, N/m].")), least(si("kd", "Damping of mode pd [N m s/rad, N s/m]; without it 0.")),
       param::positive(si("effort", "Largest torque or force of the motor [N m, N].")),
       param::positive(si("velocity",
                          "Rate beyond which the motor does not drive the joint [rad/s, m/s]; over the last tenth of it the torque falls to "
                          "nothing. Needs `effort`.")),
       least(si("damping", "Viscous damping of the bearing [N m s/rad, N s/m].")),
       least(si("friction", "Dry friction of the bearing [N m, N], in full from 0.001 rad/s, 0.1 mm/s on.")),
       least(si("stiffness", "Of a spring in the joint [N m/rad, N/m].")),
       optional(of(Param::Kind::number, "rest", Unit::any, std::nullopt, "Angle or travel at which that spring is at ease; without it 0.")),
       least(si("armature", "Inertia of the motor's rotor times the square of its gear [kg m^2, kg]."))}};
  for (Param& p : target_params()) t.params.push_back(std::move(p));
  t.is_list = true;
  return t;
}();

}  // namespace

const ParamTable& table() { return kDrive; }

Entry read(const Params& p, bool is_static, const model::Model& model, Index joint) {
  const bool slides = model.joints[joint].type == model::JointType::prismatic;
  const std::string& mode = p.text("mode");
  Entry e;
  e.joint = p.text("joint"), e.where = p.where();
  e.mode = mode == "pd" ? Mode::pd : mode == "effort" ? Mode::effort : mode == "kinematic" ? Mode::kinematic : Mode::passive;
  const auto number = [&](const char* key, double& to, bool allowed, const char* why) {
    if (!p.has(key)) return;
    if (!allowed) throw Error(Exit::scene, p.at(key).where(), std::string(key) + " has no meaning " + why);
    to = p.number(key);
  };
  const std::string of_mode = "in a drive of mode " + mode;
  const bool motor = e.mode == Mode::pd || e.mode == Mode::effort;
  number("kp", e.kp, e.mode == Mode::pd, of_mode.c_str());
  number("kd", e.kd, e.mode == Mode::pd, of_mode.c_str());
  number("effort", e.effort, motor, of_mode.c_str());
  number("velocity", e.velocity, motor, of_mode.c_str());
  number("damping", e.damping, e.mode != Mode::kinematic, of_mode.c_str());
  number("friction", e.friction, e.mode != Mode::kinematic, of_mode.c_str());
  number("stiffness", e.stiffness, e.mode != Mode::kinematic, of_mode.c_str());
  number("rest", e.rest, p.has("stiffness"), "without 'stiffness'");
  number("armature", e.armature, e.mode != Mode::kinematic, of_mode.c_str());
  if (is_static)
    for (const char* key : {"kd", "velocity", "damping", "friction", "armature"})
      if (p.has(key)) throw Error(Exit::scene, p.at(key).where(), std::string(key) + " has no meaning in a static scene: there are no rates");
  if (e.mode == Mode::pd && !p.has("kp")) throw Error(Exit::scene, p.where(), "a drive of mode pd needs 'kp', its stiffness [N m/rad, N/m]");
  if (p.has("velocity") && !p.has("effort"))
    throw Error(Exit::scene, p.at("velocity").where(), "velocity needs 'effort', the torque that goes where the joint is that fast");
  if (e.mode == Mode::passive) {
    if (Target::any(p)) throw Error(Exit::scene, p.where(), "a drive of mode passive has no target");
    if (!e.drags()) throw Error(Exit::scene, p.where(), "a drive of mode passive needs 'damping', 'friction', 'stiffness' or 'armature'");
  } else {
    e.target = Target(p, e.mode == Mode::effort ? (slides ? Quantity::force : Quantity::torque) : slides ? Quantity::travel : Quantity::angle);
    if (p.has("gait")) e.target.step(Gait(p.at("gait"), model, joint));
  }
  return e;
}

}  // namespace mortise::effects::drive
