#include "audit/walking_lag.h"

#include <algorithm>

#include "audit/archived.h"
#include "audit/tuning.h"
#include "effects/roles.h"

namespace mortise::audit {

WalkingLag::WalkingLag(const model::ModelInput& input) {
  if (const Integration integration = integration_of(input.scene); integration.second_order) step_ = integration.step;
  const Params& effects = input.scene.at("effects");
  for (const std::string& load : effects::of_role(effects, effects::Role::load))
    if (effects.at(load).has("acceleration")) down_ += effects.at(load).vec3("acceleration");
  if (down_.norm() > 0) down_.normalize();
}

void WalkingLag::state(const std::vector<double>& points, const std::vector<MovingBody>& bodies) {
  if (std::isnan(step_) || bodies.empty()) return;
  groups_.resize(bodies.size());
  value_ = NAN;
  const auto across = [this](const Vec3& a) { return Vec3(a - down_ * down_.dot(a)); };
  for (std::size_t g = 0; g < bodies.size(); ++g) {
    Vec3 x = Vec3::Zero(), v = Vec3::Zero();
    double mass = 0;
    const MovingBody* any = nullptr;
    for (const MovingBody& b : bodies)
      if (b.walks && b.group == g) any = &b, mass += b.body.mass(), x += b.body.mass() * b.x, v += b.body.mass() * b.v;
    if (!any) continue;
    Group& of = groups_[g];
    x = across(x / mass), v = across(v / mass);
    Eigen::Map<Vec3> start(of.start), last(of.v), changed(of.dv);
    if (of.states == 0) start = x, of.least = tuning::kCarriedStill * 2 * radius_of_group(bodies, *any, points);
    const Vec3 change = v - last;
    if (of.states > 1) of.jumps += (change - changed).norm();
    last = v, changed = change, ++of.states;
    value_ = std::fmax(value_, tuning::kWalks * step_ / 4 * of.jumps / std::max((x - start).norm(), of.least));
  }
}

void WalkingLag::checkpoint(Archive& archive) {
  archive_all(archive, "walking.groups", groups_);
  archive.io("walking.value", value_);
}

}  // namespace mortise::audit
