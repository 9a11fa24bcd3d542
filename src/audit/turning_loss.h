#pragma once
// A body that turns is carried straight on and brought back to its size in every step, which takes energy that no force took. In a step of length h,
// with phi = |omega| h, of the energy E_t = 1/2 omega . I omega of turning about its own centre
//     backward Euler   2 phi^2        (the angle of the next step is atan(sin phi / (2 - cos phi)) = phi (1 - phi^2 + ...))
//     BDF2             phi^4 / (1 + 4 phi^2)    (what its recurrence on a circle loses once started, within 5 % for phi up to 0.4)
// so a ball that rolls for long is too slow. free_motion_loss sees it of bodies in flight; this is of all that turn as no pin and no kinematic drive
// says, in contact and under motors too. Where a body rolls, free or as a wheel on joints (a leg turns by less than kWheel), whatever else energy is
// lost by than friction makes it slower too: facets of a round body, that strike one after the other; of a step the larger of the two counts.
// What is supported, driven or rolls gets its energy of turning from elsewhere, and gives it there: the loss is held against the largest energy of
// all that is not given. A body in flight, or on a joint without a motor, has its own alone while it touches nothing: of each such body the losses
// are also held against the most that it turned with in flight, where that is more than kTurns of its energy of motion. What rolls on a body that
// goes as the scene says (a belt) has beside the energy of all that is carried about little of its own: its losses are also held against the most
// that it moved and turned with as seen from there, as long as it does. What kinematic drives turn goes as they say, but their torques and their work
// are by this more than they should be, which is a sum of its own.
#include <vector>

#include "audit/moving_body.h"
#include "base/archive.h"
#include "base/snapshot.h"
#include "model/input.h"

namespace mortise::audit {

class TurningLoss {
 public:
  explicit TurningLoss(const model::ModelInput& input);
  // lost: by the step that led to this state, without friction [J].
  void state(const std::vector<double>& points, const std::vector<MovingBody>& bodies, double lost);
  void step(bool first_order);             // that led to that state
  double sum() const { return sum_; }      // of all steps [J]; NaN without a time step
  double given() const { return given_; }  // of what kinematic drives turn [J]
  double of_its_own() const;               // the largest share of its own energy that a body lost, in flight or carried
  void checkpoint(Archive& archive);

 private:
  Integration integration_;
  double sum_ = NAN, of_first_ = 0, of_second_ = 0;  // of the last step, by its order
  double given_ = 0, given_first_ = 0, given_second_ = 0;
  // Per body: the most that it turned with in flight, and had of energy of motion then [J]; lost there so far; in the last step, there or carried, by
  // its order [J].
  std::vector<double> turned_, moved_, lost_, lost_first_, lost_second_;
  double most_ = 0;  // share of their own of those that touched something since, or are carried no more
  // Per body that is carried: the most that it moves and turns with as seen from what carries it, and lost there so far [J].
  std::vector<double> seen_, lost_seen_;
  std::vector<double> rolled_;  // angle of what rolls on joints, since it began to [rad], 3 per body
  double before_wheel_ = 0;     // lost so far by what may be a wheel or a leg [J]
};

}  // namespace mortise::audit
