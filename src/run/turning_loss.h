#pragma once
// A body that turns is carried straight on and brought back to its size in every step, which takes energy that no force took. In a step of length h,
// with phi = |omega| h, of the energy E_t = 1/2 omega . I omega of turning about its own centre
//     backward Euler   2 phi^2        (the angle of the next step is atan(sin phi / (2 - cos phi)) = phi (1 - phi^2 + ...))
//     BDF2             phi^4 / (1 + 4 phi^2)    (what its recurrence on a circle loses once started, within 5 % for phi up to 0.4)
// so a ball that rolls for long is too slow. free_motion_loss sees it of bodies in flight; this is of all that turn as no pin and no kinematic drive
// says, in contact and under motors too. Where a free body rolls, whatever else energy is lost by than friction makes it slower too: facets of a
// round body, that strike one after the other; of a step the larger of the two counts.
#include <vector>

#include "base/archive.h"
#include "base/snapshot.h"
#include "model/input.h"
#include "run/moving_body.h"

namespace mortise::run {

class TurningLoss {
 public:
  explicit TurningLoss(const model::ModelInput& input);
  // lost: by the step that led to this state, without friction [J].
  void state(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies, double lost);
  void step(bool first_order);         // that led to that state
  double sum() const { return sum_; }  // of all steps [J]; NaN without a time step
  void checkpoint(Archive& archive);

 private:
  Integration integration_;
  double sum_ = NAN, of_first_ = 0, of_second_ = 0;  // of the last step, by its order
};

}  // namespace mortise::run
