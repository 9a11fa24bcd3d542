#pragma once
// How far a robot that walks is from where it should be. What changes at once - a foot that comes down, slips, lets go - any integrator smears over a
// step or two: with v the velocity of all that hangs together, across gravity,
//     e = kWalks h/4 sum over steps |v_n - 2 v_{n-1} + v_{n-2}|   [m]   with one of second order,
// which is of second order where velocities are smooth, and of first where they jump, and
//     e = kWalksDamped h/2 sum over steps |v_n - v_{n-1}|         [m]   with backward Euler,
// where other errors of a cycle do not make up for each other as those of smooth ways do (lagging_ways.h). Of mechanisms with motors that nothing
// holds.
#include <vector>

#include "audit/moving_body.h"
#include "base/archive.h"
#include "model/input.h"

namespace mortise::audit {

class WalkingLag {
 public:
  explicit WalkingLag(const model::ModelInput& input);
  void state(const std::vector<double>& points, const std::vector<MovingBody>& bodies);
  // e over the way, or over a share of the size; the largest. NaN where nothing walks.
  double value() const { return value_; }
  void checkpoint(Archive& archive);

 private:
  struct Group {
    double states = 0, least = 0, jumps = 0;  // of them there were; smallest way that counts [m]; the sum so far, times its factors [m/s]
    double start[3] = {0, 0, 0}, v[3] = {0, 0, 0}, dv[3] = {0, 0, 0};
  };
  Vec3 down_;  // along gravity; zero without
  Integration integration_;
  std::vector<Group> groups_;  // by number of a body
  double value_ = NAN;
};

}  // namespace mortise::audit
