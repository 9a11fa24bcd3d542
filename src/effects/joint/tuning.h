#pragma once
// Numbers of the augmented Lagrangian of joints (equation.h), with their reasons.

namespace mortise::effects::joint::tuning {

// K: of the inertia of all bodies at their lever over the square of the step. An update of lambda leaves of |c| about what else resists over K, which
// at that inertia is a thousandth or less; much larger, and rounding of an angle would be a torque that Newton's method sees.
inline constexpr double kOfInertia = 100;
// In statics: of the weight of all bodies at their lever, per rad or per lever.
inline constexpr double kOfEffort = 1e4;
inline constexpr double kMiss = 1e-10;     // [rad], and of the lever [m]: the equation holds
inline constexpr double kMostMiss = 1e-6;  // what no state of the model may miss it by
inline constexpr double kFalls = 0.1;      // an update that leaves more of |c| than this was too soft:
inline constexpr double kStiffer = 100;    // the next ones are stiffer by this

}  // namespace mortise::effects::joint::tuning
