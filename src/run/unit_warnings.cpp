#include "run/unit_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "effects/roles.h"
#include "run/tuning.h"
#include "run/warning_text.h"

namespace mortise::run {
namespace {

// What a motor aims at by keys: least and largest.
std::pair<double, double> span_of(const Params& target) {
  if (target.kind() != Params::Kind::table) return {target.as_number(), target.as_number()};
  const std::vector<double> values = target.numbers("value");
  return {*std::min_element(values.begin(), values.end()), *std::max_element(values.begin(), values.end())};
}

void of_target(const Params& drive, const Params& joint, const char* key, std::vector<std::string>& out) {
  const Params* target = drive.find(key);
  if (!target) return;
  const auto [low, high] = span_of(*target);
  const bool angle = key == std::string("angle");
  const double most = std::max(std::abs(low), std::abs(high));
  // Wheels turn on; degrees are whole numbers, and few.
  if (angle && more_than_a_turn(most) && most <= 360 && most == std::floor(most)) {
    out.push_back(at(target->where(), fmt::format("the motor of '{}' aims at {:g} rad, which is more than a turn; degrees are written '{:g} deg'",
                                                  drive.text("joint"), most, most)));
    return;
  }
  const Params* limits = joint.find(angle ? "angle_limits" : "travel_limits");
  if (!limits) return;
  const double least = limits->as_numbers().front(), largest = limits->as_numbers().back(), room = 1e-6 * (largest - least);
  if (low >= least - room && high <= largest + room) return;
  out.push_back(at(target->where(), fmt::format("the motor of '{}' aims at {:.4g} {}, beyond the limits of the joint, {:.4g} and {:.4g}; is the "
                                                "unit right?",
                                                drive.text("joint"), low < least - room ? low : high, angle ? "rad" : "m", least, largest)));
}

// Of motors that are given a position exactly that is an error.
void of_motors(const Params& effects, std::vector<std::string>& out) {
  const Params *drives = effects.find("drive"), *joints = effects.find("joint");
  if (!drives || !joints) return;
  for (const Params& drive : drives->items())
    for (const Params& joint : joints->items()) {
      const Params* name = joint.find("name");
      if (drive.text("mode") != "pd" || !name || name->as_text() != drive.text("joint")) continue;
      of_target(drive, joint, "angle", out);
      of_target(drive, joint, "travel", out);
    }
}

void above(const Params& block, const char* key, double most, const std::string& path, const char* unit, std::vector<std::string>& out) {
  const Params* p = block.find(key);
  if (p && p->as_number() > most)
    out.push_back(at(p->where(), fmt::format("{}.{} is {:.3g}{}{}; is the unit right?", path, key, p->as_number(), *unit ? " " : "", unit)));
}

}  // namespace

std::vector<std::string> unit_warnings(const model::ModelInput& input) {
  std::vector<std::string> out;
  const Params& effects = input.scene.at("effects");
  of_motors(effects, out);
  for (const std::string& name : effects::of_role(effects, effects::Role::follower))
    above(effects.at(name), "mu", tuning::kRoughest, "effects." + name, "", out);
  for (const std::string& name : effects::of_role(effects, effects::Role::contact))
    above(effects.at(name), "stiffness", tuning::kStiffestLayer, "effects." + name, "Pa", out);
  for (const model::BodyInput& body : input.bodies) {
    above(body.params, "mass", tuning::kMostMass, "bodies." + body.name, "kg", out);
    const Params* position = body.params.find("position");
    if (position && position->as_vec3().norm() > tuning::kFarthest)
      out.push_back(at(position->where(), fmt::format("'{}' is {:.3g} m from the origin, where places are known to {:.1g} m only; is the unit right?",
                                                      body.name, position->as_vec3().norm(), 1e-16 * position->as_vec3().norm())));
  }
  return out;
}

}  // namespace mortise::run
