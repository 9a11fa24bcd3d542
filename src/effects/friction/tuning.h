#pragma once
// Every number of this folder that was chosen, with its reason.

namespace mortise::effects::friction::tuning {

// Of the softening of f0 along the slip, after a step that was cut (law.h): with 0 a light bead on a heavy neighbour (H77) creeps for 140 iterations
// in a step, with 0.5 and more turntable and conveyor (H52, H33) lose half of what it gains.
inline constexpr double kCutSoftening = 0.3;

// Of scenes that do not say (creep.h).
inline constexpr double kCreepSpeed = 1e-4;  // [m/s]
inline constexpr double kOfLayer = 0.05;     // of d_hat, in a step

}  // namespace mortise::effects::friction::tuning
