#pragma once
#include <vector>

#include "model/input.h"

namespace mortise::run {

// Of all points of bodies: which go as pins (in all directions, for good) or bonds say, so that a body has no say there.
std::vector<bool> held_points(const model::ModelInput& input);

}  // namespace mortise::run
