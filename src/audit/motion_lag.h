#pragma once
// How far backward Euler is ahead or behind of what moves (lagging_ways.h): as seen from the world and from what carries it (carried_lag.h); and how
// far any integrator is from where robots walk to (walking_lag.h). In the last state; and where a body that a quantity asks for the largest or the
// smallest displacement of turns back to its start, as the top of a toss may be little beside a fall that comes after.
#include <set>
#include <string>
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
  double value() const { return std::fmax(std::fmax(value_, turned_back_), walking_.value()); }
  void checkpoint(Archive& archive);

 private:
  double step_ = NAN;                   // h [s]
  long steps_ = 0;                      // since the start
  std::vector<double> start_, turned_;  // 3 per body: centre of mass [m]; how far it has turned since [rad]
  LaggingWays centres_, turns_;
  CarriedLag carried_;
  WalkingLag walking_;
  double value_ = NAN;
  std::set<std::string> asked_;  // bodies
  std::vector<double> comes_;    // of every body, 1: it goes back to its start
  double turned_back_ = NAN;     // the largest where it turned
};

}  // namespace mortise::audit
