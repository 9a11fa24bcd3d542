#pragma once
// What a drive aims at over time: keys of the scene or of a file, plus a sine; or the steps of a leg.
#include <cmath>
#include <optional>
#include <vector>

#include "base/param_table.h"
#include "base/params.h"
#include "effects/drive/gait.h"

namespace mortise::effects::drive {

// The keys of a drive's block that say it.
std::vector<Param> target_params();

enum class Quantity { angle, travel, torque, force };  // [rad], [m], [N m], [N]

class Target {
 public:
  Target() = default;
  Target(const Params& entry, Quantity what);  // throws Error(Exit::scene)
  void step(const Gait& gait) { gait_ = gait; }
  double operator()(double t) const { return gait_ ? (*gait_)(t) : keys_(t) + amplitude_ * std::sin(omega_ * t + phase_); }

  const std::vector<double>& keys() const { return keys_.keys(); }

  // Does the block aim at anything, or at this?
  static bool any(const Params& entry);

 private:
  Schedule keys_{Params::make_number(0)};
  std::optional<Gait> gait_;
  double amplitude_ = 0, omega_ = 0, phase_ = 0;  // omega [1/s]
};

}  // namespace mortise::effects::drive
