#include "run/warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "audit/holds.h"
#include "audit/volumetric.h"
#include "base/snapshot.h"
#include "effects/roles.h"
#include "engine/effect_tables.h"
#include "geometry/bounds.h"
#include "geometry/rigid_motion.h"
#include "model/bonded.h"
#include "run/corners.h"
#include "run/idle_joints.h"
#include "run/tuning.h"
#include "run/unit_warnings.h"
#include "run/warning_text.h"
#include "scene/edge_lengths.h"
#include "scene/pass_through.h"
#include "sensors/sensors.h"

namespace mortise::run {
namespace {

void of_materials(const Params& scene, std::vector<std::string>& out) {
  const Params* materials = scene.find("materials");
  if (!materials) return;
  for (const auto& [name, m] : materials->entries()) {
    const auto outside = [&](const char* key, const char* unit, double lowest, double highest, const char* low, const char* high) {
      const Params* p = m.find(key);
      if (!p || (p->as_number() >= lowest && p->as_number() <= highest)) return;
      out.push_back(at(p->where(), fmt::format("materials.{}.{} is {:.3g} {}, {}; is the unit right?", name, key, p->as_number(), unit,
                                               p->as_number() < lowest ? low : high)));
    };
    outside("youngs_modulus", "Pa", tuning::kSoftest, tuning::kStiffest, "softer than the softest tissue", "stiffer than diamond");
    outside("density", "kg/m^3", tuning::kLightest, tuning::kHeaviest, "lighter than any foam", "heavier than any metal");
  }
}

void of_contact(const model::ModelInput& input, std::vector<std::string>& out) {
  const Params& effects = input.scene.at("effects");
  for (const std::string& name : effects::of_role(effects, effects::Role::contact)) {
    const Params* d_hat = effects.at(name).find("d_hat");
    if (!d_hat) continue;
    for (const model::BodyInput& body : input.bodies) {
      if (body.nodes.empty()) continue;
      const double size = geometry::bounds_of(body.nodes).size().maxCoeff();
      if (d_hat->as_number() <= tuning::kThickest * size) continue;
      out.push_back(at(d_hat->where(),
                       fmt::format("effects.{}.d_hat is {:.3g} m, {:.2g} times the size of body '{}' ({:.3g} m): bodies are kept that far apart",
                                   name, d_hat->as_number(), d_hat->as_number() / size, body.name, size)));
      break;
    }
  }
}

void of_friction(const Params& scene, std::vector<std::string>& out) {
  const Params& effects = scene.at("effects");
  for (const std::string& follower : effects::of_role(effects, effects::Role::follower)) {
    const Params& follows = effects.at(follower).at("follows");
    for (const std::string& contact : effects::of_role(effects, effects::Role::contact))
      if (contact != follows.as_text())
        out.push_back(
            at(follows.where(), fmt::format("effects.{} follows {}: what {} presses slides freely, and where both see a pair of bodies {} may "
                                            "bear all of it; tell them apart by `pairs`",
                                            follower, follows.as_text(), contact, contact)));
  }
}

// A bond that holds a body by one node, or by nodes on a line, is a ball joint or a hinge.
void of_bonds(const model::ModelInput& input, std::vector<std::string>& out) {
  const Params* bonds = input.scene.at("effects").find("bond");
  if (!bonds) return;
  std::map<std::string, const model::BodyInput*> bodies;
  for (const model::BodyInput& body : input.bodies) bodies[body.name] = &body;
  for (const Params& bond : bonds->items()) {
    if (!bodies.count(bond.text("body")) || !bodies.count(bond.text("to"))) continue;
    const model::BodyInput &soft = *bodies.at(bond.text("body")), &stiff = *bodies.at(bond.text("to"));
    std::vector<Vec3> held;
    for (Index i : model::bonded(bond, soft, stiff)) held.push_back(soft.nodes[i]);
    if (!geometry::fixes_a_frame(held))
      out.push_back(
          at(bond.where(),
             fmt::format("the bond of '{}' holds {}: it may turn about {} (a wider `within` or a finer mesh catches more nodes)", soft.name,
                         held.size() == 1 ? "one node" : fmt::format("{} nodes on a line", held.size()), held.size() == 1 ? "it" : "that")));
  }
}

// What schedules ask for after the end is never reached. Statics run from 0 to 1, which those who count steps do not expect; of dynamics, which may
// have been made shorter, only what does not begin is told.
void of_late_keys(const Params& block, double end, bool is_static, std::vector<std::string>& out) {
  if (block.kind() == Params::Kind::list)
    for (const Params& item : block.items()) of_late_keys(item, end, is_static, out);
  if (block.kind() != Params::Kind::table) return;
  for (const auto& [key, value] : block.entries()) {
    of_late_keys(value, end, is_static, out);
    if (key != "time" || value.kind() != Params::Kind::list || value.items().empty()) continue;
    const double first = value.as_numbers().front(), last = value.as_numbers().back();
    if (is_static && last > 1)
      out.push_back(
          at(value.where(), fmt::format("the key at {:g} s is not reached: static scenes go from 0 to 1, whatever their number of steps", last)));
    if (!is_static && first > 0 && first >= end)
      out.push_back(at(value.where(), fmt::format("the first key is at {:g} s, and the scene ends at {:g} s: nothing of it is reached", first, end)));
  }
}

// Where pins say how a body goes, its velocity at the start is not asked for.
void of_velocities(const model::ModelInput& input, std::vector<std::string>& out) {
  const audit::Holds holds(input.scene.at("effects"));
  for (const model::BodyInput& body : input.bodies)
    for (const char* key : {"velocity", "angular_velocity"})
      if (body.type == model::BodyType::stiff && holds.pinned(body.name) && !body.params.vec3(key).isZero(0))
        out.push_back(at(body.params.at(key).where(), fmt::format("{} of '{}' means nothing: a pin says how it goes (motion)", key, body.name)));
}

void of_sensors(const model::ModelInput& input, std::vector<std::string>& out) {
  const sensors::Sensors sensors(input);
  for (const sensors::Sensor& s : sensors.all()) {
    const auto body = std::find_if(input.bodies.begin(), input.bodies.end(), [&](const model::BodyInput& b) { return b.name == s.body(); });
    if (const double covered = s.rest_area() / (s.spec().width * s.spec().height); covered < tuning::kLeastCovered)
      out.push_back(at(input.scene.at("sensors").at(s.name()).where(),
                       fmt::format("sensor '{}' has a surface of '{}' under {:.2g} % of its {:g} m by {:g} m only: the rest feels nothing", s.name(),
                                   s.body(), 100 * covered, s.spec().width, s.spec().height)));
    if (!sensors::turned_around(*body, s.spec())) continue;
    out.push_back(at(input.scene.at("sensors").at(s.name()).where(),
                     fmt::format("sensor '{}' lies on a surface of '{}' that faces the other way, and feels the one behind it: turn its normal",
                                 s.name(), s.body())));
  }
}

void of_rotations(const model::ModelInput& input, std::vector<std::string>& out) {
  for (const model::BodyInput& body : input.bodies) {
    const Params* rotation = body.params.find("rotation");
    const Params* angle = rotation ? rotation->find("angle") : nullptr;
    if (angle && more_than_a_turn(angle->as_number()))
      out.push_back(at(angle->where(), fmt::format("'{}' is rotated by {:.6g} rad, which is more than a turn; degrees are written '{:.6g} deg'",
                                                   body.name, angle->as_number(), angle->as_number())));
  }
}

void of_joint_limits(const Params& scene, std::vector<std::string>& out) {
  const Params* joints = scene.at("effects").find("joint");
  for (std::size_t i = 0; joints && i < joints->items().size(); ++i) {
    const Params* limits = joints->items()[i].find("angle_limits");
    if (!limits) continue;
    double most = 0;
    for (const double v : limits->as_numbers()) most = std::max(most, std::abs(v));
    if (more_than_a_turn(most) && most <= 360)
      out.push_back(
          at(limits->where(), fmt::format("angle_limits of up to {:.6g} rad are more than a turn; degrees are written '{:.6g} deg'", most, most)));
  }
}

// What lies between frames is not looked at.
void of_quantities(const Params& scene, std::vector<std::string>& out) {
  const Params* list = scene.find("quantities");
  const long every = scene.at("time").integer("frame_every");
  for (std::size_t i = 0; list && every > 1 && i < list->items().size(); ++i) {
    const Params& q = list->items()[i];
    const std::string& when = q.text("when");
    if (q.has("at") || when == "start" || when == "end" || group_of(q.text("value")) == "steps") continue;
    out.push_back(at(q.at("when").where(),
                     fmt::format("quantities.{}: the {} is of steps with frames, one in {}; 'time.frame_every: 1' takes all", i, when, every)));
  }
}

// Numbers of other units that were taken for ours: 9810 mm/s^2, an element of many times its body.
void of_units(const model::ModelInput& input, std::vector<std::string>& out) {
  const Params& effects = input.scene.at("effects");
  for (const std::string& load : effects::of_role(effects, effects::Role::load))
    if (effects.at(load).has("acceleration"))
      if (const double g = effects.at(load).vec3("acceleration").norm(); std::abs(g / tuning::kMillimetres - 1) < tuning::kNearlyThat)
        out.push_back(at(effects.at(load).at("acceleration").where(), fmt::format("{} is {:g} m/s^2: lengths are metres, here too", load, g)));
  for (const model::BodyInput& body : input.bodies) {
    const Params* shape = body.params.find("shape");
    if (!shape || body.nodes.empty()) continue;
    const double size = geometry::bounds_of(body.nodes).size().maxCoeff();
    if (shape->has("mesh") && size > tuning::kLargestMesh)
      out.push_back(at(shape->where(), fmt::format("'{}' is {:.3g} m large: a file in millimetres needs `scale: 0.001`", body.name, size)));
    for (const scene::EdgeLength& edge : scene::edge_lengths(*shape))
      if (edge.length > tuning::kCoarsest * size)
        out.push_back(at(shape->where(), fmt::format("{} is {:g} m, and '{}' is {:g} m large", edge.path, edge.length, body.name, size)));
  }
}

}  // namespace

std::vector<std::string> warnings(const model::ModelInput& input) {
  std::vector<std::string> out;
  of_materials(input.scene, out);
  const Params& time = input.scene.at("time");
  if (const Params* step = time.find("step"); step && step->as_number() > tuning::kLongestStep)
    out.push_back(
        at(step->where(), fmt::format("time.step is {:.3g} s: motions and oscillations shorter than that are damped away", step->as_number())));
  of_late_keys(input.scene.at("effects"), scene::end_time(input.scene), time.text("mode") == "static", out);
  of_velocities(input, out);
  of_contact(input, out);
  of_friction(input.scene, out);
  of_bonds(input, out);
  of_sensors(input, out);
  of_quantities(input.scene, out);
  of_rotations(input, out);
  of_units(input, out);
  of_joint_limits(input.scene, out);
  for (std::string& unit : unit_warnings(input)) out.push_back(std::move(unit));
  for (std::string& idle : idle_joints(input)) out.push_back(std::move(idle));
  for (std::string& corner : corners(input)) out.push_back(std::move(corner));
  for (std::string& risk : audit::locking_risks(input)) out.push_back(std::move(risk));
  for (const scene::PassThrough& p : scene::pass_through(input.scene, engine::effect_tables()))
    if (p.everything) out.push_back(p.text());
  return out;
}

}  // namespace mortise::run
