#include "run/corners.h"

#include <fmt/format.h>

#include <cmath>

#include "audit/entries.h"
#include "effects/drive/target.h"
#include "effects/roles.h"
#include "run/tuning.h"
#include "run/warning_text.h"

namespace mortise::run {
namespace {

using effects::drive::Quantity;
using effects::drive::Target;

// How often its speed changes at a key by more than a share of the fastest, if steps see it: keys closer than two of them draw a curve.
int bends(const Target& target, double step) {
  const std::vector<double>& t = target.keys();
  std::vector<double> speed;
  double fastest = 0;
  for (std::size_t k = 1; k < t.size(); ++k) {
    if (t[k] - t[k - 1] < 1.5 * step) return 0;
    speed.push_back((target(t[k]) - target(t[k - 1])) / (t[k] - t[k - 1]));
    fastest = std::max(fastest, std::abs(speed.back()));
  }
  int out = 0;
  for (std::size_t k = 1; k < speed.size(); ++k) out += std::abs(speed[k] - speed[k - 1]) > tuning::kBend * fastest;
  return out;
}

}  // namespace

std::vector<std::string> corners(const model::ModelInput& input) {
  std::vector<std::string> out;
  const Params &effects = input.scene.at("effects"), &time = input.scene.at("time");
  if (time.text("mode") == "static" || effects::of_role(effects, effects::Role::inertia).empty()) return out;
  for (const Params& drive : audit::entries(effects, "drive")) {
    if (drive.text("mode") != "kinematic" || drive.text("interpolation") != "linear" || drive.has("gait") || !Target::any(drive)) continue;
    const std::optional<Params> joint = audit::joint_named(effects, drive.text("joint"));
    const bool slides = joint && joint->text("type") == "prismatic";
    const Target target(drive, slides ? Quantity::travel : Quantity::angle);
    if (bends(target, time.number("step")) < tuning::kFewBends) continue;
    out.push_back(at(drive.where(), fmt::format("the target of '{0}' goes straight between {1} keys: its speed jumps at each, and its {2} is that of "
                                                "jumps, the larger the shorter the step; 'interpolation: smooth' goes round them",
                                                drive.text("joint"), target.keys().size(), slides ? "force" : "torque")));
  }
  return out;
}

}  // namespace mortise::run
