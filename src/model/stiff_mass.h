#pragma once
#include "model/input.h"

namespace mortise::model {

// The mass of a stiff body, in the place where it is at rest.
struct StiffMass {
  double mass = 0;                    // [kg]
  double volume = 0;                  // of its shape [m^3]
  Vec3 centre = Vec3::Zero();         // of mass [m]
  Mat3 second_moment = Mat3::Zero();  // int rho X X^T dV, X from the centre of mass, world axes [kg m^2]
};

// Of its shape filled evenly with the density of its material or the body's own `mass`; or as `mass` and `inertia` state it: with I the tensor of
// inertia about the centre of mass,
//     I = int rho (X.X 1 - X X^T) dV,     int rho X X^T dV = tr(I)/2 1 - I,
// which has to be positive: no principal moment reaches the sum of the other two. Throws Error(Exit::scene) that names the body.
StiffMass stiff_mass(const BodyInput& body);

}  // namespace mortise::model
