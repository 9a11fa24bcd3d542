#pragma once
// An entry of the scene's list `drive`, as one joint of it has it.
#include <cmath>

#include "effects/drive/target.h"

namespace mortise::effects::drive {

const ParamTable& table();  // of an entry

enum class Mode { pd, effort, kinematic, passive };

struct Entry {
  std::string joint;
  Mode mode = Mode::passive;
  SourceLoc where;
  Target target{};
  double kp = 0, kd = 0, effort = INFINITY, velocity = INFINITY, damping = 0, friction = 0;
  double stiffness = 0, rest = 0, armature = 0;
  bool holds() const { return kp > 0 || stiffness > 0 || armature > 0; }
  bool drags() const { return damping > 0 || friction > 0 || stiffness > 0 || armature > 0; }
};

// Throws Error(Exit::scene) where a key has no meaning in the mode, or one is missing.
Entry read(const Params& entry, bool is_static, const model::Model& model, Index joint);

}  // namespace mortise::effects::drive
