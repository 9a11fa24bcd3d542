#pragma once
// `checks`: what a run of the scene has to fulfil. The vocabulary stands here; src/run/checks.* measures it.
#include <set>
#include <string>

#include "base/param_table.h"
#include "base/params.h"
#include "scene/diagnostics.h"
#include "scene/scene.h"
#include "scene/tables.h"

namespace mortise::scene {

const ParamTable& check_table();
const Variants& check_variants();  // by `quantity`

// Bounds that belong together, bodies that exist, effects without which there is nothing to measure.
void check_checks(const Params& root, std::span<const EffectTable> effects, const std::set<std::string>& incomplete, Diagnostics& errors);

}  // namespace mortise::scene
