#pragma once
// The scene's joints as ties and as coordinates.
#include "effects/tie.h"
#include "model/joints.h"

namespace mortise::effects::joint {

extern const ParamTable table;

struct Read {
  std::vector<model::Tie> ties;
  std::vector<model::Joint> joints;  // `tie` counts from the first of these ties
  std::vector<double> stop_effort;   // of every joint [N m]; 0: to be chosen
};
// Throws Error(Exit::scene).
Read read(const Params& list, const model::Model& model);

}  // namespace mortise::effects::joint
