#pragma once
#include "base/params.h"
#include "scene/diagnostics.h"
#include "scene/yaml.h"

namespace mortise::scene {

// Units of numbers whose quantity another key decides (Unit::any): those of drives by the type of the joint, those of a colour scale by the field.
// They are gone once a number is read, so they are looked for in what was written.
void check_written_units(const Node& root, const Params& resolved, Diagnostics& errors);

}  // namespace mortise::scene
