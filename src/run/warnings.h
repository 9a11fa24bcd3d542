#pragma once
#include <string>
#include <vector>

#include "model/input.h"

namespace mortise::run {

// What is allowed but hardly ever meant: `check` and the start of a run say it, one sentence each.
std::vector<std::string> warnings(const model::ModelInput& input);

}  // namespace mortise::run
