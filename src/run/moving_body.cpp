#include "run/moving_body.h"

#include <algorithm>

#include "effects/roles.h"
#include "run/holds.h"

namespace mortise::run {

MovingBodies::MovingBodies(const model::ModelInput& input) {
  const Holds holds(input.scene.at("effects"));
  const double step = integration_of(input.scene).step;
  const auto& pairs = holds.together();
  for (const model::BodyInput& b : input.bodies) {
    if (b.type == model::BodyType::half_space) continue;
    const bool tied = std::any_of(pairs.begin(), pairs.end(), [&](const auto& p) { return p.first == b.name || p.second == b.name; });
    const bool held = holds.held(b.name), given = holds.given(b.name), free = !held && !tied;
    who_.push_back(
        {held, given, given && !holds.pinned(b.name), free, free || (held && !given && !holds.motored(b.name)), holds.damped(b.name, step)});
  }
}

std::vector<MovingBody> MovingBodies::at(const Snapshot& said, const std::vector<double>& points, const std::vector<MeasuredBody>& bodies) const {
  std::vector<MovingBody> out;
  const Snapshot::Values *velocity = said.of_points("velocity", 3), *force = said.of_points("contact_force", 3);
  if (!velocity || velocity->empty()) return out;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MeasuredBody& b = bodies[i];
    const auto pushed = [&] {
      const auto begin = force->begin() + static_cast<std::ptrdiff_t>(3 * b.first);
      return std::any_of(begin, begin + static_cast<std::ptrdiff_t>(3 * b.count), [](double f) { return f != 0; });
    };
    // Slides on the world are supported, across their axis.
    const bool led = who_[i].given || (said.has("supports/" + b.name + "_x") && !who_[i].held);
    out.push_back({b, b.mean(points, points), b.mean(*velocity, points), b.spin(*velocity, points), force && !force->empty() && pushed(),
                   who_[i].given, who_[i].driven, led, who_[i].free, who_[i].swings, who_[i].damped,
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
