#pragma once

namespace mortise::effects {

// What numbers of a run are wrong by, and a scene that goes beside it (solver/follow.cpp) can be right in by a share.
enum class Fault {
  steps,     // of an integrator: rates and accelerations are differences over steps
  gap,       // of contact: what presses is a spring, and leaves a gap
  solution,  // of the solver: equations are solved to a tolerance
  mesh,      // of soft bodies: stresses are what elements can take on, and masses may stand on nodes
  volumes,   // of soft bodies: what of that is changes of volume
};

}  // namespace mortise::effects
