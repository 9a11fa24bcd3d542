#include "audit/stiff_strain.h"

#include <algorithm>
#include <cmath>

#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "geometry/rigid_motion.h"

namespace mortise::audit {

StiffStrain::StiffStrain(const model::ModelInput& input) {
  std::size_t first = 0;
  for (const model::BodyInput& body : input.bodies) {
    if (body.type == model::BodyType::half_space) continue;
    if (body.type == model::BodyType::stiff) {
      Vec3 middle = Vec3::Zero();
      for (const Vec3& x : body.nodes) middle += x / static_cast<double>(body.nodes.size());
      double radius = 0;
      for (const Vec3& x : body.nodes) radius = std::max(radius, (x - middle).norm());
      bodies_.push_back({first, body.nodes, radius});
    }
    first += body.nodes.size();
  }
}

void StiffStrain::state(const Snapshot& said) {
  const std::span<const double> displacement = of_points(said, "displacement", 3);
  if (!bodies_.empty() && !displacement.empty()) displacement_.assign(displacement.begin(), displacement.end());
}

double StiffStrain::share() const {
  if (displacement_.empty()) return before_;
  double worst = NAN;
  for (const Body& b : bodies_) {
    std::vector<Vec3> now;
    double way = tuning::kStillStiff * b.radius, strained = 0;
    for (std::size_t i = 0; i < b.rest.size(); ++i) {
      const Vec3 u = at(displacement_, b.first + i);
      now.push_back(b.rest[i] + u);
      way = std::max(way, u.norm());
    }
    const geometry::Motion rigid = geometry::nearest_motion_of_any(b.rest, now);
    for (std::size_t i = 0; i < now.size(); ++i) strained = std::max(strained, (now[i] - rigid.R * b.rest[i] - rigid.t).norm());
    worst = std::fmax(worst, strained / way);
  }
  return worst;
}

void StiffStrain::checkpoint(Archive& archive) {
  double now = share();
  archive.io("stiff_strain", now);
  if (archive.loading()) before_ = now, displacement_.clear();
}

}  // namespace mortise::audit
