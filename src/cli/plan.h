#pragma once
#include <string>

#include "base/params.h"

namespace mortise::cli {

// Throws the error with which a run of the scene would be refused before its first step: meshes, bodies that touch, sensors beside their body.
void check_model(const Params& scene);

// What a run of the scene would consist of: bodies, effects, and for each effect its buffers and kernels.
std::string plan_text(const Params& scene);

}  // namespace mortise::cli
