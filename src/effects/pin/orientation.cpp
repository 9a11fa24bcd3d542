#include "effects/pin/orientation.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace mortise::effects::pin {

Orientation::Orientation(const Params& block, const Params& time, bool smooth) : centre_(block.vec3("centre")) {
  constexpr double kUnit = 1e-6;  // of its length: rounding of what was written
  const std::size_t keys = time.items().size();
  for (const char* part : {"w", "x", "y", "z"})
    if (const Params& list = block.at(part); list.items().size() != keys)
      throw Error(Exit::scene, list.where(), "has " + std::to_string(list.items().size()) + " keys where 'time' has " + std::to_string(keys));
  for (std::size_t k = 0; k < keys; ++k) {
    const auto part = [&](const char* name) { return block.at(name).items()[k].as_number(); };
    Eigen::Quaterniond q(part("w"), part("x"), part("y"), part("z"));
    if (!(std::abs(q.norm() - 1) < kUnit))
      throw Error(Exit::scene, block.at("w").items()[k].where(), "the quaternion of key " + std::to_string(k + 1) + " is not of unit length");
    q.normalize();
    if (k > 0 && q.dot(key_.back()) < 0) q.coeffs() *= -1;
    if (k > 0) turn_.push_back(key_.back().angularDistance(q));
    key_.push_back(q), time_.push_back(time.items()[k].as_number());
  }
  if (!smooth) return;
  speed_.assign(keys, 0.0);
  for (std::size_t k = 1; k + 1 < keys; ++k) {
    const double h0 = time_[k] - time_[k - 1], h1 = time_[k + 1] - time_[k], d0 = turn_[k - 1] / h0, d1 = turn_[k] / h1;
    if (!(d0 * d1 > 0)) continue;
    const Vec3 before = (key_[k] * key_[k - 1].conjugate()).vec().normalized(), after = (key_[k + 1] * key_[k].conjugate()).vec().normalized();
    const double a = (h0 + 2 * h1) / (3 * (h0 + h1));
    speed_[k] = std::max(before.dot(after), 0.0) * d0 * d1 / (a * d1 + (1 - a) * d0);
  }
}

Mat3 Orientation::at(double t) const {
  if (t <= time_.front()) return key_.front().toRotationMatrix();
  if (t >= time_.back()) return key_.back().toRotationMatrix();
  const auto k = static_cast<std::size_t>(std::upper_bound(time_.begin(), time_.end(), t) - time_.begin()) - 1;
  if (turn_[k] == 0) return key_[k].toRotationMatrix();
  const double h = time_[k + 1] - time_[k], s = (t - time_[k]) / h, r = 1 - s;
  const double share = speed_.empty() ? s : s * s * (3 - 2 * s) + h * s * r * (r * speed_[k] - s * speed_[k + 1]) / turn_[k];
  return key_[k].slerp(share, key_[k + 1]).toRotationMatrix();
}

}  // namespace mortise::effects::pin
