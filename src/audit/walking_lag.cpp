#include "audit/walking_lag.h"

#include <algorithm>
#include <map>

#include "audit/archived.h"
#include "audit/tuning.h"

namespace mortise::audit {

WalkingLag::WalkingLag(const model::ModelInput& input)
    : down_(gravity_of(input.scene).stableNormalized()), integration_(integration_of(input.scene)) {}

void WalkingLag::state(const std::vector<double>& points, const std::vector<MovingBody>& bodies) {
  if (std::isnan(integration_.step) || bodies.empty()) return;
  groups_.resize(bodies.size());
  value_ = NAN;
  const auto across = [this](const Vec3& a) { return Vec3(a - down_ * down_.dot(a)); };
  struct Sums {
    double mass = 0;
    Vec3 x = Vec3::Zero(), v = Vec3::Zero();
    const MovingBody* last = nullptr;
  };
  std::map<std::size_t, Sums> sums;  // by group
  for (const MovingBody& b : bodies)
    if (b.walks()) {
      Sums& s = sums[b.group];
      s.mass += b.body.mass(), s.x += b.body.mass() * b.x, s.v += b.body.mass() * b.v, s.last = &b;
    }
  for (const auto& [g, sum] : sums) {
    Group& of = groups_[g];
    const Vec3 x = across(sum.x / sum.mass), v = across(sum.v / sum.mass);
    Eigen::Map<Vec3> start(of.start), last(of.v), changed(of.dv);
    if (of.states == 0) start = x, of.least = tuning::kCarriedStill * 2 * radius_of_group(bodies, *sum.last, points);
    const Vec3 change = v - last;
    if (integration_.second_order)
      of.jumps += of.states > 1 ? tuning::kWalks / 4 * (change - changed).norm() : 0;
    else
      of.jumps += of.states > 0 ? tuning::kWalksDamped / 2 * change.norm() : 0;
    last = v, changed = change, ++of.states;
    value_ = std::fmax(value_, integration_.step * of.jumps / std::max((x - start).norm(), of.least));
  }
}

void WalkingLag::checkpoint(Archive& archive) {
  archive_all(archive, "walking.groups", groups_);
  archive.io("walking.value", value_);
}

}  // namespace mortise::audit
