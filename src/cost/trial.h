#pragma once
// The first steps of a scene, taken to see how long they take.
#include "engine/engine.h"

namespace mortise::cost {

struct Trial {
  long steps = 0, iterations = 0;  // that were taken to their end
  double seconds = 0;              // CPU time of these [s]
  double later_iterations = 0;     // per step, of the later half of them
};

// Takes steps until `most` seconds of CPU time are over or `steps` are taken. The engine has begun and is of no use afterwards. A step that fails
// ends it.
Trial try_steps(engine::Engine& engine, long steps, double most);

}  // namespace mortise::cost
