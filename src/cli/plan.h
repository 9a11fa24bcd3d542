#pragma once
#include <string>

#include "base/params.h"

namespace mortise::cli {

// What a run of the scene would consist of: bodies, effects, for each effect its buffers and kernels, and how long it will take.
std::string plan_text(const Params& scene);

}  // namespace mortise::cli
