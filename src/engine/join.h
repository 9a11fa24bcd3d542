#pragma once
// Several scenes that differ in numbers only as the environments of one model.
#include <string>
#include <vector>

#include "model/input.h"

namespace mortise::engine {

// Environment e is scenes[e], which all come of one scene with `environments`.
model::ModelInput join(const std::vector<const model::ModelInput*>& scenes);

// Why what a path of environments.vary names cannot differ between the environments of one model; empty where it can.
std::string common_to_a_model(const Params& scene, const std::string& path);

}  // namespace mortise::engine
