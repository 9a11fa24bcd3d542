#pragma once
// What the time step makes of joints that motors with gains (mode pd) drive, or springs alone: backward Euler damps how a joint swings about its
// target, and with that the largest torques; BDF2 overshoots where it swings in few steps. Such joints are followed beside the run in kMotorParts
// steps for every one of its own, as
//
//     M theta'' + D theta' + K theta = g(t),     K = kp + S,  D = kd + c     (S, c: of the joint's spring and bearing),
//
// where M_jk = sum <phi_j, phi_k> over all bodies that hang on them, phi_j the velocity of a body that goes with a unit of theta_j, < , > the product
// by mass, and g, straight from step to step, is what the run's own angles and rates say it is at the end of a step of length h,
//
//     g = M v' + D v + K theta + dJ - M dv',     J_j = sum <phi_j, a>,
//
// v the rates, v' and a what they and velocities of bodies change by, as the integrator takes it, d the change in the step (kp times the target is a
// part of it, which goes as straight). The last two terms are of accelerations that others impose, as a hand does on its jaws: with backward Euler
// they are late by h, else there are none. u is what the run's angle is more than theta, and
// the torque of a motor should be kp (target - theta) - kd theta', within steps as well, where the largest ones mostly are. A motor that gives all of
// its effort has no kp and no kd. Not followed: what hangs on joints that nothing drives or efforts do, and mechanisms that nothing holds. Soft
// bodies count as points. While something of it touches, what that weighs and gives is in no M and no K: it goes as a swing fitted to J_j / M_jj then
// (fitted_swing.h), as joints with springs alone do, whose phase others tell. What is at a stop starts anew when it is free again.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "audit/fitted_swing.h"
#include "audit/holds.h"
#include "audit/joint_sums.h"
#include "audit/moving_body.h"
#include "base/archive.h"
#include "base/snapshot.h"
#include "model/input.h"

namespace mortise::audit {

class MotorLag {
 public:
  explicit MotorLag(const model::ModelInput& input);
  void state(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies);
  // Of the joint where it is most: |u| at most, over the farthest that it was from its start, or a share of the size of what it moves. NaN: there is
  // none of these.
  double way() const;
  // Of the motor where it is most: how far its largest torque one way is off, over that as it should be, or kOtherWay of the largest both ways.
  // Where a robot stands still all of them are rounding.
  double torque() const;
  void checkpoint(Archive& archive);

 private:
  // A joint with a motor: what the scene says, and names of what is reported.
  struct Motor : Holds::Motor {
    std::string joint, coordinate, rate, torque, target;
    bool slides;
    double rest;  // of a spring alone
    bool saturated(const Snapshot& said) const { return has_gains() && std::abs(said.at(torque)) >= effort; }
    double wanted(const Snapshot& said) const { return has_gains() ? said.at(target) : rest; }
    // Of the motor, or of a spring alone.
    double torque_of(const Snapshot& said) const { return has_gains() ? said.at(torque) : torque_at(rest, said.at(coordinate), 0); }
    double torque_at(double target, double theta, double rate) const {
      return has_gains() ? std::clamp(kp * (target - theta) - kd * rate, -effort, effort) : spring * (target - theta);
    }
  };
  // A joint as a swing: its state, and that of its target; J_j / M_jj and what its rate changes by.
  struct Swing {
    FittedSwing beside;
    double states = 0, x = 0, slope = 0, v = 0, target = 0, target_slope = 0, driven = 0, a = 0;
    void state(double x, double v, double target, double driven, double a, double h);
  };
  // Of a motor: theta and its rate; of the last state g, J, v', v and the target, and v of the one before; the start; the size of what it moves; what
  // was largest so far, of torques against its coordinate and along it.
  struct Error {
    Swing swing;
    double reach = 0;  // the farthest that it should have been from its start, as a swing
    double theta = 0, rate = 0, g = 0, J = 0, a = 0, v = 0, v_before = 0, target = 0, start = 0, size = 0;
    double wrong = 0, far = 0, torque[2] = {0, 0}, as_should[2] = {0, 0};
    static void see(double (&largest)[2], double torque) { largest[torque > 0] = std::fmax(largest[torque > 0], std::abs(torque)); }
    double should() const { return std::fmax(as_should[0], as_should[1]); }
  };
  enum class How { not_at_all, as_a_swing, as_a_mechanism };  // a joint is followed in a step
  void advance(const JointSums::Sums& sums, const std::vector<How>& how, const Snapshot& said);

  Integration integration_;
  Holds holds_;
  std::vector<Motor> motors_;
  std::optional<JointSums> sums_;  // rotors of motors left out
  std::vector<Error> errors_;
  long states_ = 0;
};

}  // namespace mortise::audit
