#pragma once
#include "base/param_table.h"
#include "scene/yaml.h"

namespace mortise::scene {

// Puts what `over` says into `under`, key by key where a block has keys; single values, lists of numbers and blocks that hold one of several things
// (shapes) are replaced, and so is a body of another type. In lists of blocks an entry takes the place of what it says in the one with the same
// `name` (or `joint`, where entries have no name); others are added.
void merge(Node& under, const Node& over, const ParamTable& table);

}  // namespace mortise::scene
