#pragma once
// What is told of how soft bodies resist changes of volume (`volumetric` of their materials).
#include <string>
#include <vector>

#include "model/input.h"

namespace mortise::audit {

// "averaged over 96 clusters", "averaged over every element" or "full".
std::string volumetric(const model::BodyInput& body);
// Of every body whose elements may lock, as averages are switched off, why.
std::vector<std::string> locking_risks(const model::ModelInput& input);

}  // namespace mortise::audit
