#include "audit/crept.h"

#include <algorithm>
#include <cmath>

#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "geometry/bounds.h"

namespace mortise::audit {

Crept::Crept(const model::ModelInput& input) {
  for (const auto& [effect, law] : friction_laws(input)) speed_ = std::fmax(speed_, law.creep_speed);
  std::size_t first = 0;
  for (const model::BodyInput& body : input.bodies) {
    if (body.type == model::BodyType::half_space) continue;
    bodies_.push_back({first, body.nodes.size(), body.nodes.empty() ? INFINITY : geometry::bounds_of(body.nodes).size().norm()});
    first += body.nodes.size();
  }
}

void Crept::state(const Snapshot& said, const std::vector<Rubbing>& rubs) {
  for (auto& [bodies, pair] : pairs_) pair.now = 0;
  for (const auto& [law, of] : rubs)
    for (const auto& [bodies, friction] : of) {
      Pair& pair = pairs_[bodies];
      if (friction.speed() < law.creep_speed) pair.now = std::max(pair.now, friction.speed());
    }
  if (const Snapshot::Values* u = said.of_points("displacement", 3))
    for (auto& [bodies, pair] : pairs_) pair.far = std::max(pair.far, farthest(bodies, *u));
}

double Crept::farthest(const Bodies& bodies, const Snapshot::Values& displacement) const {
  std::vector<Body> two;
  std::vector<Vec3> gone;  // each on the whole
  for (const std::size_t b : {bodies.first, bodies.second}) {
    const Body& body = two.emplace_back(b < bodies_.size() ? bodies_[b] : Body{});
    Vec3& mean = gone.emplace_back(Vec3::Zero());
    for (std::size_t i = body.first; i < body.first + body.count; ++i) mean += at(displacement, i) / static_cast<double>(body.count);
  }
  double far = 0;
  for (const Vec3& with : gone)
    for (const Body& body : two)
      for (std::size_t i = body.first; i < body.first + body.count; ++i) far = std::max(far, (at(displacement, i) - with).norm());
  return far;
}

void Crept::step(double dt) {
  for (auto& [bodies, pair] : pairs_) pair.crept += pair.now * dt;
}

double Crept::share() const {
  if (std::isnan(speed_)) return NAN;
  double most = 0;
  for (const auto& [bodies, pair] : pairs_) {
    double size = INFINITY;
    for (const std::size_t b : {bodies.first, bodies.second})
      if (b < bodies_.size()) size = std::min(size, bodies_[b].size);
    most = std::max(most, pair.crept / std::max(pair.far, tuning::kStill * size));
  }
  return most;
}

void Crept::checkpoint(Archive& archive) {
  std::vector<double> values;
  for (const auto& [bodies, pair] : pairs_)
    for (const double v : {static_cast<double>(bodies.first), static_cast<double>(bodies.second), pair.crept, pair.far}) values.push_back(v);
  archive.io("crept.pairs", values);
  if (!archive.loading()) return;
  pairs_.clear();
  for (std::size_t i = 0; i + 3 < values.size(); i += 4)
    pairs_[{static_cast<std::size_t>(values[i]), static_cast<std::size_t>(values[i + 1])}] = {values[i + 2], values[i + 3], 0};
}

}  // namespace mortise::audit
