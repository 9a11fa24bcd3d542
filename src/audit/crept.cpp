#include "audit/crept.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

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
  std::set<Bodies> touching;
  for (auto& [bodies, pair] : pairs_) pair.now = 0;
  for (const Rubbing& rub : rubs)
    for (const auto& [bodies, friction] : rub) {
      Pair& pair = pairs_[bodies];
      touching.insert(bodies);
      pair.now = std::max(pair.now, friction.creep());
    }
  const Snapshot::Values* u = said.of_points("displacement", 3);
  if (!u) return;
  for (auto& [bodies, pair] : pairs_) {
    const bool touched = std::exchange(pair.touches, touching.count(bodies) > 0);
    if (!pair.touches) continue;
    const Vec3 now[] = {gone(bodies.first, *u), gone(bodies.second, *u)};
    for (int k = 0; k < 2; ++k) {
      if (!touched) pair.apart[k] += now[k] - pair.last[k];
      pair.last[k] = now[k];
    }
    pair.far = std::max(pair.far, farthest(bodies, pair, *u));
  }
}

Vec3 Crept::gone(std::size_t b, const Snapshot::Values& displacement) const {
  Vec3 mean = Vec3::Zero();
  if (b >= bodies_.size()) return mean;
  const Body& body = bodies_[b];
  for (std::size_t i = body.first; i < body.first + body.count; ++i) mean += at(displacement, i) / static_cast<double>(body.count);
  return mean;
}

double Crept::farthest(const Bodies& bodies, const Pair& pair, const Snapshot::Values& displacement) const {
  const std::size_t two[] = {bodies.first, bodies.second};
  double far = 0;
  for (int k = 0; k < 2; ++k) {
    const Body body = two[k] < bodies_.size() ? bodies_[two[k]] : Body{};
    for (int with = 0; with < 2; ++with)
      for (std::size_t i = body.first; i < body.first + body.count; ++i)
        far = std::max(far, (at(displacement, i) - pair.apart[k] - (pair.last[with] - pair.apart[with])).norm());
  }
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
  for (const auto& [bodies, pair] : pairs_) {
    for (const double v : {static_cast<double>(bodies.first), static_cast<double>(bodies.second), pair.crept, pair.far, pair.touches ? 1.0 : 0.0})
      values.push_back(v);
    for (const Vec3* v : {pair.last, pair.last + 1, pair.apart, pair.apart + 1}) values.insert(values.end(), v->data(), v->data() + 3);
  }
  archive.io("crept.pairs", values);
  if (!archive.loading()) return;
  pairs_.clear();
  constexpr std::size_t kEach = 17;
  for (const double* v = values.data(); v + kEach <= values.data() + values.size(); v += kEach) {
    const auto vec = [&](int k) { return Vec3(v[5 + 3 * k], v[6 + 3 * k], v[7 + 3 * k]); };
    pairs_[{static_cast<std::size_t>(v[0]), static_cast<std::size_t>(v[1])}] = {v[2], v[3], 0, v[4] != 0, {vec(0), vec(1)}, {vec(2), vec(3)}};
  }
}

}  // namespace mortise::audit
