#pragma once
// What the time step makes late of forces on what stays in touch while motors, springs or what carries it shake it. Backward Euler balances the
// forces at the end of a step with the m a of before, BDF2 with one that errs by a share of its second difference; contact and friction bear the
// rest. Of what hangs together and is held or driven, with P = sum m a of its bodies that are not given, in touch in all states looked at,
//
//     R = |P_1 - P_0|  (backward Euler),      R = 2/3 |P_2 - 2 P_1 + P_0|  (BDF2),
//
// no more than in the steps just before: a jump of an acceleration is no error for longer. Along the sum of the forces of contact R is held against
// their largest sum in the run, where something soft touches (between stiff bodies these are strikes). Across it, against the largest friction or P,
// pi R counts with backward Euler: a slip that is a swing of frequency omega, from stick to stick, is damped by the share pi omega h, and R is
// omega h of its forces; and with BDF2 R of Q = P less friction, which may jump. Where what presses it from two sides has no direction, all of R
// counts along. Near a resonance the force is wrong by more.
#include <cmath>
#include <vector>

#include "audit/moving_body.h"
#include "base/archive.h"
#include "model/input.h"

namespace mortise::audit {

class LateInertia {
 public:
  explicit LateInertia(const model::ModelInput& input) : integration_(integration_of(input.scene)) {}
  void state(const Snapshot& said, const std::vector<MovingBody>& bodies);
  void step(bool first_order);  // that led to that state
  double share() const;         // of what hangs together, the largest; NaN where nothing such touches
  void checkpoint(Archive& archive);

 private:
  // Of one direction, along the contact or across it: R in the last steps; the largest that lasted; what it is held against [N].
  struct Side {
    double last[3] = {}, late = 0, force = 0;
    void see(double R);
    double share() const { return force > 0 ? late / force : NAN; }
  };
  // Of what hangs together, by its number (`MovingBody::group`): states in touch; P and Q of the last one and of the one before [N].
  struct Group {
    double states = 0, P[2][3] = {}, Q[2][3] = {};
    Side along, across;
  };
  Integration integration_;
  std::vector<Group> groups_;
  long states_ = 0;  // before this one
};

}  // namespace mortise::audit
