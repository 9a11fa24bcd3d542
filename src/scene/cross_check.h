#pragma once
#include <set>
#include <string>

#include "base/param_table.h"
#include "base/params.h"
#include "scene/diagnostics.h"

namespace mortise::scene {

// What one block demands of another: names that must exist, effects that a kind of body needs, modes that exclude each other.
// Works on a tree with holes; in blocks of `misspelt` (dotted paths) missing keys are not reported a second time.
void cross_check(const Params& root, const std::set<std::string>& misspelt, Diagnostics& errors);

}  // namespace mortise::scene
