#pragma once
// What every effect holds and launches: found by doing once, at the state at hand, all that a step does.
#include "solver/potential.h"

namespace mortise::solver {

struct Rehearsed {
  std::string effect;
  std::vector<effects::PlanItem> buffers;
  std::vector<std::string> kernels;
};

// Effects' begin_step must have run. Nothing is changed by it.
std::vector<Rehearsed> rehearse(const model::Model& model, Potential& potential);

}  // namespace mortise::solver
