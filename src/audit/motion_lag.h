#pragma once
// How far backward Euler is ahead or behind of what moves (lagging_ways.h): as seen from the world and from what carries it (carried_lag.h); and how
// far any integrator is from where robots walk to (walking_lag.h).
#include <vector>

#include "audit/carried_lag.h"
#include "audit/lagging_ways.h"
#include "audit/moving_body.h"
#include "audit/walking_lag.h"
#include "base/archive.h"
#include "model/input.h"

namespace mortise::audit {

class MotionLag {
 public:
  explicit MotionLag(const model::ModelInput& input);
  void state(const std::vector<double>& points, const std::vector<MovingBody>& bodies);
  // Of the last state: e over the farthest that the body should have been from its start, or should have turned, or, where it hardly moved, over a
  // share of its size; the largest of all bodies that go as no pin and no kinematic drive says. NaN without either.
  double value() const { return std::fmax(value_, walking_.value()); }
  void checkpoint(Archive& archive);

 private:
  double step_ = NAN;                   // h [s]
  long steps_ = 0;                      // since the start
  std::vector<double> start_, turned_;  // 3 per body: centre of mass [m]; how far it has turned since [rad]
  LaggingWays centres_, turns_;
  CarriedLag carried_;
  WalkingLag walking_;
  double value_ = NAN;
};

}  // namespace mortise::audit
