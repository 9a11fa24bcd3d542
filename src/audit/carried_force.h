#pragma once
// What the time step makes of the swings of stiff bodies that soft ones or springs carry on what pins and kinematic drives move: an object in the
// pads of a hand, a block on a mount. What carries them jolts them, or shakes them near their resonance, and nothing in the model damps that but the
// integrator. With x, v, a the centre of such a body, its velocity and acceleration in every state, r and r' the first two as seen from its carrier,
// along every axis of the world
//
//     a = -kappa r - c r' + what it stands in,
//
// kappa and c fitted to the changes of the last states (each weighs kForgets of the one after); c is 0 where that follows, too. Of what ends a step
// of length h at x_1 the motion between is x_0 + (x_1 - x_0) t/h, which the forces there do not follow; what the body should be beside it is
//
//     e'' + c e' + kappa e = a - x'',     x'' = sum over the states of delta(t) (x_1 - 2 x_0 + x_-1) / h,
//
// whatever drives it, and whatever integrates it; its acceleration is a* = a - kappa e - c e'. Told is what the largest |m (a* - g)| differs by from
// the largest |m (a - g)|, along the axis where it is most, over the largest force on the body.
//
// e is 0 where the fit leaves more than 1 - kFits of the changes' square, and until what began with a touch has died down to kSettled of its changes
// of acceleration: what it brought is not asked for (strikes_damped sees the largest force).
#include <vector>

#include "audit/moving_body.h"
#include "base/archive.h"
#include "model/input.h"

namespace mortise::audit {

class CarriedForce {
 public:
  explicit CarriedForce(const model::ModelInput& input) : integration_(integration_of(input.scene)), gravity_(gravity_of(input.scene)) {}
  void state(const std::vector<double>& points, const std::vector<MovingBody>& bodies);
  double share() const;  // of the body where it is most; NaN where nothing is carried so
  void checkpoint(Archive& archive);

 private:
  // Along one axis: sums of r r, r r', r' r', r a, r' a and a a over the changes so far; e [m] and e' [m/s], NaN: it does
  // not swing; the largest |a - g| and |a* - g| [m/s^2].
  struct Axis {
    double rr = 0, rv = 0, vv = 0, ra = 0, va = 0, aa = 0;
    double e = 0, rate = NAN;
    double largest = 0, meant = 0;
    void fit(double r, double v, double a);
    // Over a step in which a goes from a_0 to a_1, before which x changed its rate by kink; gives a* - a in its end.
    double swing(double a_0, double a_1, double kink, double h);
    void see(double a, double beside);
  };
  // Of a body: states in a row with the same carrier, and its number; x, its last change over h, v - V and a in the last state; what a changed by at
  // most; the largest force, over its mass [m/s^2]; has it settled?
  struct Body {
    double states = 0, by = -1, x[3] = {}, slope[3] = {}, seen[3] = {}, carrier[3] = {}, a[3] = {}, unrest = 0, settled = 0, force = 0;
    Axis axes[3];
    double share() const;
  };
  // there: velocity of its carrier at its centre [m/s]; rounding: no way [m].
  void follow(Body& body, const MovingBody& b, const Vec3& there, double rounding) const;

  Integration integration_;
  Vec3 gravity_;
  std::vector<Body> bodies_;
};

}  // namespace mortise::audit
