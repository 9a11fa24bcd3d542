#pragma once
// What jolts do to stiff bodies on soft ones and on springs. Where what the scene moves (pins, kinematic drives) changes its acceleration at once, by
// D, as between two keys, a body that it carries on something that gives follows and overshoots by D: nothing in the model damps that but backward
// Euler, which does so at once where a swing takes a few steps only. With a the acceleration of the body, A that of what carries it at the body's
// centre, g gravity,
//
//     o = max (a - A).D / |D|  until the next jolt,     missing = |D| - o,     share = m missing / (max F + m missing),
//
// F = m |a - g|, or what presses it where that is more: the part of the largest force on the body that is damped away, of a body that has caught up
// (o > 0, but for kCaughtUp of |D|). A jolt: A stands before and after, and goes from one to the other in three steps. Velocities that change at once
// are none.
#include <vector>

#include "audit/moving_body.h"
#include "base/archive.h"
#include "model/input.h"

namespace mortise::audit {

class Jolted {
 public:
  explicit Jolted(const model::ModelInput& input);
  void state(const std::vector<MovingBody>& bodies);
  double value() const;  // of the body where it is most; NaN where nothing is jolted, or without backward Euler
  void checkpoint(Archive& archive);

 private:
  static constexpr int kKept = 5;
  // Of a body: states in a row with the same carrier; its number; A of the last ones, the newest last; D; o so far; what was missing most [m/s^2];
  // the largest F [N]; the carrier's velocity there in the last state [m/s].
  struct Body {
    double states = 0, by = -1, A[3 * kKept] = {}, D[3] = {0, 0, 0}, o = 0, missing = 0, force = 0, mass = 0, there[3] = {0, 0, 0};
    double missing_now() const;
  };
  static void look(Body& body, const Vec3& a);

  double step_ = NAN;  // h [s]
  Vec3 gravity_;
  std::vector<Body> bodies_;
};

}  // namespace mortise::audit
