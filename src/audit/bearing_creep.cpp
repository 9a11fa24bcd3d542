#include "audit/bearing_creep.h"

#include <algorithm>
#include <cmath>

#include "audit/entries.h"
#include "audit/moving_body.h"
#include "audit/tuning.h"
#include "effects/drive/tuning.h"
#include "geometry/bounds.h"

namespace mortise::audit {

BearingCreep::BearingCreep(const model::ModelInput& input) {
  const Params& effects = input.scene.at("effects");
  if (std::isnan(integration_of(input.scene).step)) return;
  for (const Params& drive : entries(effects, "drive")) {
    const std::string mode = drive.text("mode"), name = drive.text("joint");
    const std::optional<Params> joint = joint_named(effects, name);
    if (!joint || !drive.has("friction") || (mode != "passive" && mode != "effort")) continue;
    const bool slides = joint->text("type") == "prismatic";
    double least = tuning::kSettles;
    for (const model::BodyInput& body : input.bodies)
      if (slides && body.name == joint->text("body") && !body.nodes.empty()) least = tuning::kSettles * geometry::bounds_of(body.nodes).size().norm();
    bearings_.push_back({"joint/" + name + (slides ? "_travel" : "_angle"), "joint/" + name + "_rate",
                         slides ? effects::drive::tuning::kCreepSlide : effects::drive::tuning::kCreep, least});
  }
}

void BearingCreep::state(const Snapshot& said) {
  for (Bearing& b : bearings_) {
    const double value = said.at(b.value), rate = std::abs(said.at(b.rate));
    if (std::isnan(b.start)) b.start = value;
    b.far = std::fmax(b.far, std::abs(value - b.start));
    b.now = rate < b.speed ? rate : 0;
  }
}

void BearingCreep::step(double dt) {
  for (Bearing& b : bearings_) b.crept += b.now * dt;
}

double BearingCreep::share() const {
  double most = NAN;
  for (const Bearing& b : bearings_) most = std::fmax(most, b.crept / std::max(b.far, b.least));
  return most;
}

void BearingCreep::checkpoint(Archive& archive) {
  for (std::size_t i = 0; i < bearings_.size(); ++i) {
    const std::string prefix = "bearing" + std::to_string(i) + ".";
    archive.io(prefix + "start", bearings_[i].start);
    archive.io(prefix + "far", bearings_[i].far);
    archive.io(prefix + "crept", bearings_[i].crept);
  }
}

}  // namespace mortise::audit
