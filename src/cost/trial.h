#pragma once
// The first steps of a scene, taken to see how long they take.
#include <vector>

#include "engine/engine.h"

namespace mortise::cost {

struct Trial {
  long steps = 0, iterations = 0;  // that were taken to their end
  double seconds = 0;              // CPU time of these [s]
  double later_iterations = 0;     // per step, of the later half of them
  double each = 0;                 // CPU time of an iteration, those of a step that was broken off too [s]; of a first one that was, the least
  std::vector<long> taken{};       // iterations of every step
};

// Takes steps until `most` seconds of CPU time are over or `steps` are taken, in all with those that were taken `before`. The engine has begun. A
// step that is broken off can be taken again; one that fails ends it.
Trial try_steps(engine::Engine& engine, long steps, double most, Trial before = {});

}  // namespace mortise::cost
