#pragma once
// Backward Euler takes the velocity at a step's end for all of it. Under smooth forces a body is then ahead of where it should be by
//     e = h/2 |v - v_0|   [m],   h the time step, v_0 the velocity at the start,
// exactly so in a fall and in a slide: of the way g t^2/2 that is the share h/t. Under a force that grows the velocity itself is ahead, by half a
// step's growth: with a_0 the acceleration in the first step and t the time since, what |v - v_0| is more than |a_0| t counts twice. What turned back
// or came to rest has lost it again (a wrong phase, a swing that is damped: free_motion_loss sees those).
#include <vector>

#include "base/archive.h"
#include "model/input.h"
#include "run/moving_body.h"

namespace mortise::run {

class MotionLag {
 public:
  explicit MotionLag(const model::ModelInput& input);
  void state(const std::vector<double>& points, const std::vector<MovingBody>& bodies);
  // Of the last state: e over the farthest that the body has been from its start, less e, or, where it hardly moved, a share of its size; the largest
  // of all bodies that go as no pin and no kinematic drive says. NaN without backward Euler.
  double value() const { return value_; }
  void checkpoint(Archive& archive);

 private:
  double step_ = NAN;                // h [s]
  long steps_ = 0;                   // since the start
  std::vector<double> a0_;           // per body [m/s^2]
  std::vector<double> start_, v0_;   // 3 per body: centre of mass [m], its velocity [m/s]
  std::vector<double> least_, far_;  // per body: smallest way that counts, farthest from the start so far [m]
  double value_ = NAN;
};

}  // namespace mortise::run
