#include "run/moving_body.h"

#include <algorithm>
#include <map>
#include <set>

#include "base/disjoint_sets.h"
#include "effects/roles.h"
#include "effects/tie_name.h"
#include "run/entries.h"
#include "run/holds.h"

namespace mortise::run {

MovingBodies::MovingBodies(const model::ModelInput& input) {
  const Holds holds(input.scene.at("effects"));
  const double step = integration_of(input.scene).step;
  std::map<std::string, std::size_t> number;
  for (const model::BodyInput& b : input.bodies)
    if (b.type != model::BodyType::half_space) number.emplace(b.name, number.size());
  std::vector<bool> tied(number.size(), false), motored(number.size(), false);
  DisjointSets sets(number.size());
  for (const auto& [one, other] : holds.together()) {
    for (const std::string& name : {one, other})
      if (number.count(name)) tied[number.at(name)] = true;
    if (number.count(one) && number.count(other) && !holds.given(one) && !holds.given(other)) sets.join(number.at(one), number.at(other));
  }
  const Params& effects = input.scene.at("effects");
  std::set<std::string> driven_joints;
  for (const Params& p : entries(effects, "drive")) {
    if (p.text("mode") == "passive") continue;
    driven_joints.insert(p.text("joint"));
    if (const std::optional<Params> joint = joint_named(effects, p.text("joint")))
      if (const auto body = number.find(joint->text("body")); body != number.end()) motored[sets.of(body->second)] = true;
  }
  for (const model::BodyInput& b : input.bodies) {
    if (b.type == model::BodyType::half_space) continue;
    const std::size_t i = number.at(b.name), group = sets.of(i);
    const bool held = holds.held(b.name), given = holds.given(b.name);
    const bool swings = held ? !given && !holds.motored(b.name) : !motored[group];
    std::vector<std::string> stops;
    bool spins = !held && !tied[i];
    for (const Params& p : entries(effects, "joint")) {
      if (p.text("body") != b.name) continue;
      stops.push_back("joint/" + effects::tie_name(p) + "_stop");
      spins = p.text("type") != "fixed" && !p.has("mimic") && !driven_joints.count(effects::tie_name(p));
    }
    who_.push_back(
        {held, given, given && !holds.pinned(b.name), !held && !tied[i], swings, spins, holds.damped(b.name, step), group, std::move(stops)});
  }
}

std::vector<MovingBody> MovingBodies::at(const Snapshot& said, const std::vector<double>& points, const std::vector<MeasuredBody>& bodies) const {
  std::vector<MovingBody> out;
  const Snapshot::Values *velocity = said.of_points("velocity", 3), *force = said.of_points("contact_force", 3);
  if (!velocity || velocity->empty()) return out;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MeasuredBody& b = bodies[i];
    double pushed = 0;
    Vec3 pressed = Vec3::Zero();
    for (std::size_t p = b.first; force && !force->empty() && p < b.first + b.count; ++p) {
      const double size = vector_at(*force, p).norm();
      pushed += size, pressed += size * vector_at(points, p);
    }
    if (pushed > 0) pressed /= pushed;
    const auto at_it = [&](const std::string& stop) { return said.has(stop) && said.at(stop) != 0; };
    const bool stopped = std::any_of(who_[i].stops.begin(), who_[i].stops.end(), at_it);
    // Slides on the world are supported, across their axis.
    const bool led = who_[i].given || (said.has("supports/" + b.name + "_x") && !who_[i].held);
    out.push_back({b, b.mean(points, points), b.mean(*velocity, points), b.spin(*velocity, points), pushed > 0, stopped, pressed, who_[i].given,
                   who_[i].driven, led, who_[i].free, who_[i].swings, who_[i].spins, who_[i].group, who_[i].damped,
                   b.soft() ? 0.0 : b.turning_energy(*velocity, points)});
  }
  return out;
}

Integration integration_of(const Params& scene) {
  const Params &effects = scene.at("effects"), *time = scene.find("time");
  const std::vector<std::string> inertia = effects::of_role(effects, effects::Role::inertia);
  const Params* step = time ? time->find("step") : nullptr;
  if (!step || inertia.empty()) return {};
  const Params* integrator = effects.at(inertia.front()).find("integrator");
  return {step->as_number(), integrator && integrator->as_text() == "bdf2"};
}

}  // namespace mortise::run
