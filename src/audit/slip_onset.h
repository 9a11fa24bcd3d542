#pragma once
// Slip that sets in where the acceleration of what carries a body jumps, as it does at the keys of a motion, smooth ones too. What is carried goes
// where it is told, so that its velocity over a step is the mean of it; friction's impulse is that of the whole step at once, and backward Euler is
// ahead (or behind) by what it gives too early. With D_0 and D_3 what the carrier's velocity changed by in the step before the jump and in the one
// after it, B_0 and B_3 of the body the same, and two steps between,
//
//     o = sum_k B_k - B_0 - s_k (B_3 - B_0),    s_k = (D_k - D_0).(D_3 - D_0) / |D_3 - D_0|^2
//
// is what the body's velocity is too much by, from then on until it sticks. Nothing (o = 0) of what sticks all the time; what slips already before
// the jump is not counted.
#include "base/types.h"

namespace mortise::audit {

class SlipOnset {
 public:
  explicit SlipOnset(bool from_rest) : known_(from_rest ? kSteps - 1 : 0) {}
  // After a step of length h [s]: what the velocities of carrier and body changed by in it, across what presses, and the body's along the carrier
  // [m/s].
  void step(const Vec3& carrier, const Vec3& body, const Vec3& slip, double h);
  Vec3 ahead() const { return {ahead_[0], ahead_[1], ahead_[2]}; }  // of where the body should be [m]

 private:
  static constexpr int kSteps = 5;
  bool jumped() const;
  Vec3 offset() const;
  // Newest last, so many as there are; |D_3 - D_0| one step earlier; o; the fastest slip so far [m/s].
  double known_, carrier_[3 * kSteps] = {}, body_[3 * kSteps] = {}, before_ = 0, offset_[3] = {}, ahead_[3] = {}, fastest_ = 0;
};

}  // namespace mortise::audit
