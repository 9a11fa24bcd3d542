#pragma once
// What the time step makes of the swings of stiff bodies that soft ones or springs carry on what pins and kinematic drives move: an object in the
// pads of a hand, a block on a mount. What carries them jolts them, or shakes them near their resonance, and nothing in the model damps that but the
// integrator. The centre of such a body is followed beside the run along every axis of the world, as seen from its carrier (fitted_swing.h), with an
// acceleration a*. Told is what the largest |m (a* - g)| differs by from the largest |m (a - g)|, along the axis where it is most, over the largest
// force on the body.
//
// Not until what began with a touch has died down to kSettled of its changes of acceleration: what it brought is not asked for (strikes_damped sees
// the largest force).
#include <vector>

#include "audit/fitted_swing.h"
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
  // Along one axis; the largest |a - g| and |a* - g| [m/s^2].
  struct Axis {
    FittedSwing swing;
    double largest = 0, meant = 0;
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
