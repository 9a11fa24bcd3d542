#pragma once
// How far a robot that walks is from where it should be, with an integrator of second order (with backward Euler lagging_ways.h tells). What changes
// at once - a foot that comes down, slips, lets go - such an integrator smears over a step or two as any other does: with v the velocity of all that
// hangs together, across gravity,
//     e = kWalks h/4 sum over steps |v_n - 2 v_{n-1} + v_{n-2}|   [m],
// which is of second order where velocities are smooth, and of first where they jump. Of mechanisms with motors that nothing holds.
#include <vector>

#include "audit/moving_body.h"
#include "base/archive.h"
#include "model/input.h"

namespace mortise::audit {

class WalkingLag {
 public:
  explicit WalkingLag(const model::ModelInput& input);
  void state(const std::vector<double>& points, const std::vector<MovingBody>& bodies);
  // e over the way, or over a share of the size; the largest. NaN where nothing walks, or not with such an integrator.
  double value() const { return value_; }
  void checkpoint(Archive& archive);

 private:
  struct Group {
    double states = 0, least = 0, jumps = 0;  // of them there were; smallest way that counts [m]; the sum so far [m/s]
    double start[3] = {0, 0, 0}, v[3] = {0, 0, 0}, dv[3] = {0, 0, 0};
  };
  Vec3 down_;                  // along gravity; zero without
  double step_ = NAN;          // h [s]
  std::vector<Group> groups_;  // by number of a body
  double value_ = NAN;
};

}  // namespace mortise::audit
