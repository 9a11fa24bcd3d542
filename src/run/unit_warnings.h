#pragma once
#include <string>
#include <vector>

#include "model/input.h"

namespace mortise::run {

// Numbers that hardly anybody means: most often a unit is missing, or is another one.
std::vector<std::string> unit_warnings(const model::ModelInput& input);

}  // namespace mortise::run
