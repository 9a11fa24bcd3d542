#pragma once
#include <set>
#include <string>

#include "base/param_table.h"
#include "base/params.h"
#include "scene/diagnostics.h"
#include "scene/scene.h"

namespace mortise::scene {

const ParamTable& sensor_table();

// Bodies that exist and can carry a grid, names, and a contact effect to read.
void check_sensors(const Params& root, std::span<const EffectTable> effects, const std::set<std::string>& incomplete, Diagnostics& errors);

}  // namespace mortise::scene
