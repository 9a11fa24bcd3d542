#include "run/sensor_reach.h"

#include <fmt/format.h>

#include <algorithm>

#include "run/tuning.h"

namespace mortise::run {

void SensorReach::see(const std::vector<sensors::Reading>& readings) {
  largest_.resize(readings.size());
  for (std::size_t s = 0; s < readings.size(); ++s) {
    const sensors::Reading& r = readings[s];
    Vec3 taxels = Vec3::Zero();
    for (std::size_t i = 0; i + 2 < r.force.size(); i += 3) taxels += Eigen::Map<const Vec3>(&r.force[i]);
    largest_[s].on_body = std::max(largest_[s].on_body, r.wrench_force.norm());
    largest_[s].on_taxels = std::max(largest_[s].on_taxels, taxels.norm());
  }
}

std::vector<std::string> SensorReach::warnings(const sensors::Sensors& sensors) const {
  std::vector<std::string> out;
  for (std::size_t s = 0; s < largest_.size(); ++s) {
    const Largest& l = largest_[s];
    if (l.on_taxels >= tuning::kLeastFelt * l.on_body) continue;
    const sensors::Sensor& sensor = sensors.all()[s];
    const double percent = 100 * l.on_taxels / l.on_body;
    out.push_back(fmt::format(
        "sensor '{}' covers {} the force on '{}' ({:.3g} N at most): the rest is beside its grid, or on surfaces that its normal does not "
        "face; does the normal point out of the body where it is touched?",
        sensor.name(), percent < 0.05 ? "none of" : fmt::format("{:.2g} % of", percent), sensor.body(), l.on_body));
  }
  return out;
}

}  // namespace mortise::run
