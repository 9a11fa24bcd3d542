#pragma once
// Forces of what goes as it is told (pins, kinematic drives). Backward Euler gives it at the end of a step the acceleration of the step before,
// a_n = (x_n - 2 x_n-1 + x_n-2)/h^2: the force that this takes is late by h. Of a motion that is smooth,
//
//     lag = sum m |a_n - a_n-1| / sum F,
//
// over the steps in which a changes by less than itself, is 2 pi/n of a sine of n steps but for where it turns; F: the force that holds the body in
// that state, or all that touches it, beside which its own inertia may be nothing. Where a motion starts or stops at once no step says anything of
// the force; but where it does so more than kJumps times, as a track that was sampled and goes straight from key to key, forces are those of its
// jumps, and all steps count. Of kinematic drives the same of their torques, with J (joint_sums.h) for m a and for F what the drive does.
#include <string>
#include <vector>

#include "audit/holds.h"
#include "audit/joint_sums.h"
#include "audit/moving_body.h"
#include "base/archive.h"
#include "model/input.h"

namespace mortise::audit {

class GivenLag {
 public:
  explicit GivenLag(const model::ModelInput& input);
  // forces: F of every body [N].
  void state(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies, const std::vector<double>& forces);
  double value() const;  // of the body or drive where it is most; NaN where none is told to move, or without backward Euler
  void checkpoint(Archive& archive);

 private:
  // Of a body or a drive: m a or J of the last state; sums of both sides, of all steps and of those in which it changes by less than itself; how
  // often it changed by more.
  struct Sides {
    double last[3] = {0, 0, 0}, late = 0, all = 0, late_smooth = 0, all_smooth = 0, jumps = 0;
    void see(const Vec3& now, double force);
    double lag() const;
  };
  double step_;  // h [s]
  bool backward_euler_;
  Holds holds_;
  std::vector<std::string> drives_;  // joints with kinematic drives
  JointSums sums_;
  std::vector<Sides> bodies_, joints_;
  long states_ = 0;
};

}  // namespace mortise::audit
