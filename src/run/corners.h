#pragma once
// Motions that are told by a track of many keys and go straight from one to the next: at each the speed jumps, and so does a force that grows as
// steps get shorter. What is meant is most often a curve that was sampled.
#include <string>
#include <vector>

#include "model/input.h"

namespace mortise::run {

// Of drives of mode kinematic, in scenes that move in time, with the place of each.
std::vector<std::string> corners(const model::ModelInput& input);

}  // namespace mortise::run
