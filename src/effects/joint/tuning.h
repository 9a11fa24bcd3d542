#pragma once
// Numbers of stops and of the augmented Lagrangian of joints, with their reasons.

namespace mortise::effects::joint::tuning {

// Stops (stop.h) begin the last fiftieth of a degree or of a millimetre before a limit, and no more than a two-hundredth of all there is: what leans
// on a stop stands before its limit by some of that, and what it presses on meanwhile lacks as much (a degree and half a millimetre made the grip of
// a pad a fifth too small). Newton's method takes two iterations more on the way there for every tenth of it.
inline constexpr double kTurn = 3.5e-4, kSlide = 2e-5, kShare = 0.005;
// Of the distance to a stop, what a step of Newton's method leaves at least; as in contact (contact/proximity.h).
inline constexpr double kKeep = 0.3;

// [rad] between the axes of joints that are tied to mimic each other: as far as rounding goes, others are equations.
inline constexpr double kParallel = 1e-9;

// Equations (equation.h):

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
