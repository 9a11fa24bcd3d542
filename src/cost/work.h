#pragma once
// What a run of a scene has to do, as far as it can be told without doing it.
#include <string>

#include "model/input.h"

namespace mortise::cost {

struct Work {
  double blocks = 0;               // of three unknowns: nodes of soft bodies, four per stiff one
  double tets = 0, quadratic = 0;  // linear and quadratic tetrahedra
  double triangles = 0;            // of surfaces that contact looks at
  double factor = 0;               // sum over soft bodies of blocks^2: what a factor of nested dissection takes in space, up to a constant
  bool statics = false, contact = false, friction = false, drives = false;
  bool iterates = false;  // conjugate gradients in place of factors
  long steps = 0;
};

// linear_solver: as the engine calls it. edges: with soft bodies' edge lengths times this, where the scene gives them, as numbers go with their
// powers.
Work work_of(const model::ModelInput& input, const std::string& linear_solver, double edges = 1);

// Names of what stays the same: of the scene but for how many steps it takes and what is written and looked at, and of its kind alone, that is its
// name, bodies and effects whatever their numbers are.
std::string same_physics(const Params& scene);
std::string same_kind(const Params& scene);

}  // namespace mortise::cost
