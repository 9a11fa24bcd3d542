#pragma once
// A body that turns is carried straight on and brought back to its size in every step, which takes energy that no force took. In a step of length h,
// with phi = |omega| h, of the energy E_t = 1/2 omega . I omega of turning about its own centre
//     backward Euler   2 phi^2        (the angle of the next step is atan(sin phi / (2 - cos phi)) = phi (1 - phi^2 + ...))
//     BDF2             phi^4 / (1 + 4 phi^2)    (what its recurrence on a circle loses once started, within 5 % for phi up to 0.4)
// so a ball that rolls for long is too slow. free_motion_loss sees it of bodies in flight, spin_loss.h of each by itself; this is of all that turn as
// no pin and no kinematic drive says, in contact and under motors too. Where a body rolls, free or as a wheel on joints (a leg turns by less than
// kWheel), whatever else energy is lost by than friction makes it slower too: facets of a round body, that strike one after the other; of a step the
// larger of the two counts. What is supported, driven or rolls gets its energy of turning from elsewhere, and gives it there: the loss is held
// against the largest energy of all that is not given. What no motor moves is held against no more than its own island has had (islands.h), and work
// of supports where these may have fed it. What rolls on a body that goes as the scene says (a belt) has beside the energy of all that is carried
// about little of its own: its losses are also held against the most that it moved and turned with, or was lifted by, as seen from there, as long as
// it does. What kinematic drives turn goes as they say, but their torques and their work are by this more than they should be, which is a sum of its
// own.
#include <vector>

#include "audit/islands.h"
#include "audit/moving_body.h"
#include "audit/own_energy.h"
#include "base/archive.h"
#include "base/snapshot.h"
#include "model/input.h"

namespace mortise::audit {

class TurningLoss {
 public:
  explicit TurningLoss(const model::ModelInput& input);
  // Of a state: lost by the step that led to it, without friction [J]; changes of velocity in it; elastic energy of every body, and energies of
  // motions that are rounding [J]; work of supports so far on what is not given [J].
  struct State {
    double lost;
    const OwnEnergy& own;
    const std::vector<double>&elastic, &least;
    double work;
  };
  void state(const std::vector<double>& points, const std::vector<MovingBody>& bodies, const State& now);
  void step(bool first_order);             // that led to that state
  double sum() const;                      // of all steps [J]; NaN without a time step
  double given() const { return given_; }  // of what kinematic drives turn [J]
  double of_its_own() const;               // the largest share of its own energy that an island lost, or a body that is carried
  void checkpoint(Archive& archive);

 private:
  struct Island {
    double sum = 0, first = 0, second = 0;  // of all steps, and of the last one by its order [J]
    double before_wheel = 0;                // lost so far by what may be a wheel or a leg [J]
    double most = 0;                        // that it has had [J]
    double motored = 0, fed = 0;            // by a motor; by what is given or supported, that moves
  };
  double of_carried() const;  // the largest share of their own
  void join(const std::vector<MovingBody>& bodies);
  void measure(const std::vector<MovingBody>& bodies, const State& now);

  Integration integration_;
  Vec3 gravity_;
  Islands islands_;
  std::vector<Island> of_island_;  // by their numbers
  std::vector<double> weight_;     // of every body at the start [J]
  double work_ = 0;
  double given_ = 0, given_first_ = 0, given_second_ = 0;
  std::vector<double> lost_first_, lost_second_;  // per body that is carried: in the last step, by its order [J]
  double most_ = 0;                               // share of their own of those that are carried no more
  // Per body that is carried: the most that it moves and turns with, and is lifted or lowered by, as seen from what carries it, and lost there so far
  // [J]; its weight, as lifted there when that began [J].
  std::vector<double> seen_, lost_seen_, lifted_;
  std::vector<double> rolled_;  // angle of what rolls on joints, since it began to [rad], 3 per body
};

}  // namespace mortise::audit
