#pragma once
#include <set>
#include <string>

#include "base/param_table.h"
#include "base/params.h"
#include "scene/diagnostics.h"
#include "scene/scene.h"

namespace mortise::scene {

// What one block demands of another: names that must exist, effects that a kind of body needs, modes that exclude each other.
// Works on a tree with holes; in `incomplete` blocks (dotted paths) nothing is reported as missing.
void cross_check(const Params& root, std::span<const EffectTable> effects, const std::set<std::string>& incomplete, Diagnostics& errors);

}  // namespace mortise::scene
