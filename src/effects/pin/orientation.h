#pragma once
// Turns from rest given as quaternions at keys. Between two keys the turn goes about one axis, the shorter way, at constant speed, or `smooth`: by a
// cubic that starts and ends at rest and never overshoots a key (as Schedule's, base/params.h). At a key where the axis changes by an angle a the
// speed is cos a of what it would be on a straight way, and nothing where the turn goes back.
#include <Eigen/Geometry>
#include <vector>

#include "base/params.h"

namespace mortise::effects::pin {

class Orientation {
 public:
  Orientation() = default;
  // `block`: centre, and lists w, x, y, z with as many entries as `time`. Throws Error(Exit::scene).
  Orientation(const Params& block, const Params& time, bool smooth);

  bool any() const { return !key_.empty(); }
  const Vec3& centre() const { return centre_; }
  Mat3 at(double t) const;

 private:
  Vec3 centre_ = Vec3::Zero();
  std::vector<double> time_;             // [s]
  std::vector<Eigen::Quaterniond> key_;  // each on the side of the one before it
  std::vector<double> turn_;             // from each key to the next [rad]
  std::vector<double> speed_;            // at the keys [rad/s]; empty: constant in between
};

}  // namespace mortise::effects::pin
