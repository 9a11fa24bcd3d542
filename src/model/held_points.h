#pragma once
#include <string>
#include <vector>

#include "model/input.h"

namespace mortise::model {

// Bit per axis that a pin's `axes` names.
unsigned mask_of(const std::string& axes);
// Of all points of bodies: which go as pins (in all directions, for good) or bonds say, so that a body has no say there.
std::vector<bool> held_points(const ModelInput& input);
// All of a body's points over those that are not held (audit/stress_error.h); 1 where all are.
double one_sided(const std::vector<bool>& held, std::size_t first, std::size_t count);

}  // namespace mortise::model
