#pragma once
#include "importers/robot/passing.h"

namespace mortise::importers {

// The scene of a machine that stands, held by its motors: floor, gravity, contact, friction, two cameras. `path`: where it will be, from which meshes
// are named; `command`: how it came about.
std::string write_scene(const Machine& machine, const std::vector<PassingPair>& passing, const std::string& path, const std::string& command);

}  // namespace mortise::importers
