#pragma once
// Backward Euler takes the velocity at a step's end for all of it. Under smooth forces a body is then ahead of where it should be by
//     e = h/2 |v - v_0|   [m],   h the time step, v_0 the velocity at the start,
// exactly so in a fall and in a slide: of the way g t^2/2 that is the share h/t. What gets slower is as far behind. Under a force that grows the
// velocity itself is ahead, by half a step's growth: with a_0 the acceleration in the first step and t the time since, what |v - v_0| is more than
// |a_0| t counts twice. The same of angles, by angular velocities. What turned back or came to rest has lost it again (a wrong phase, a swing that is
// damped: free_motion_loss sees those).
// Where motion feeds on itself (what topples: a ~ x), the velocity is multiplied, in a step by 1 / (1 - l h) where exp(l h) is right: with
// l = dv.v / (h |v|^2) that is ahead by l h^2 / 2 [s], which adds up over all steps in which the acceleration grows at nearly the rate at which the
// velocity does (under a force that grows with a power of time less than the third it does not), and counts with the velocity.
// What is carried about (a box put on a conveyor, a jaw on a hand that moves) has a way along what carries it besides, which is what somebody looks
// at: with v and the way as seen from there the same holds. Carriers are the body that goes as the scene says at the end of a chain of joints and,
// of what is free, the body that presses it, along which it slides.
#include <vector>

#include "audit/moving_body.h"
#include "base/archive.h"
#include "model/input.h"

namespace mortise::audit {

class MotionLag {
 public:
  explicit MotionLag(const model::ModelInput& input);
  void state(const std::vector<double>& points, const std::vector<MovingBody>& bodies);
  // Of the last state: e over the farthest that the body should have been from its start, or should have turned, or, where it hardly moved, over a
  // share of its size; the largest of all bodies that go as no pin and no kinematic drive says. NaN without backward Euler.
  double value() const { return value_; }
  void checkpoint(Archive& archive);

 private:
  // Ways of all bodies, of their centres [m] or of their turning [rad].
  struct Ways {
    std::vector<double> v0, a0;          // velocities at the start, 3 per body; accelerations in the first step
    std::vector<double> v_last, a_last;  // of the last step, 3 per body
    std::vector<double> ahead;           // of what multiplies [s]
    std::vector<double> least, far;      // smallest way that counts, farthest from the start so far
    void start(const Vec3& v, double least_way);
    void restart(std::size_t body, const Vec3& v);
    double lag(std::size_t body, const Vec3& way, const Vec3& velocity, double h, long steps);
    void multiply(std::size_t body, const Vec3& velocity, double h);
    void checkpoint(Archive& archive, const std::string& name);
  };
  // Of every body: what carries it (its number, or -1), for how many steps; ways of that, at the body, and of the body along it since then, 3 per
  // body [m]; the lag.
  struct Carried {
    std::vector<double> by, steps, carrier, along, lag;
    Ways ways;
  };
  double along_carrier(std::size_t body, const std::vector<MovingBody>& bodies);
  double step_ = NAN;                   // h [s]
  long steps_ = 0;                      // since the start
  std::vector<double> start_, turned_;  // 3 per body: centre of mass [m]; how far it has turned since [rad]
  Ways centres_, turns_;
  Carried carried_;
  double value_ = NAN;
};

}  // namespace mortise::audit
