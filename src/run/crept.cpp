#include "run/crept.h"

#include <algorithm>
#include <cmath>

#include "effects/friction/creep.h"
#include "effects/roles.h"
#include "geometry/bounds.h"
#include "run/tuning.h"
#include "run/vector_at.h"

namespace mortise::run {

Crept::Crept(const model::ModelInput& input) {
  const Params& effects = input.scene.at("effects");
  for (const std::string& name : effects::of_role(effects, effects::Role::follower))
    speed_[name] = effects::friction::creep_speed(effects.at(name), input);
  double smallest = INFINITY;
  for (const model::BodyInput& body : input.bodies)
    if (!body.nodes.empty()) smallest = std::min(smallest, geometry::bounds_of(body.nodes).size().norm());
  if (std::isfinite(smallest)) least_ = tuning::kStill * smallest;
}

double Crept::speed() const {
  double out = NAN;
  for (const auto& [effect, speed] : speed_) out = std::fmax(out, speed);
  return out;
}

void Crept::state(const Snapshot& said) {
  if (const Snapshot::Values* u = said.of_points("displacement", 3))
    for (std::size_t i = 0; i < u->size() / 3; ++i) far_ = std::max(far_, at(*u, i).norm());
  now_ = 0;
  for (const auto& [effect, speed] : speed_) {
    const auto force = said.row.find(effect + "/force");
    if (force == said.row.end()) continue;
    double sum = 0;
    for (std::size_t i = 0; i < force->second.size() / 3; ++i) sum += at(force->second, i).norm();
    const double slips = said.at(effect + "/power") / sum;
    if (slips < speed) now_ = std::max(now_, slips);
  }
}

void Crept::step(double dt) { crept_ += now_ * dt; }

void Crept::checkpoint(Archive& archive) {
  for (auto [name, value] : {std::pair{"crept", &crept_}, {"crept_far", &far_}}) archive.io(name, *value);
}

}  // namespace mortise::run
