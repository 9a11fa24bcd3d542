#pragma once
#include <string>

#include "base/param_table.h"
#include "scene/diagnostics.h"
#include "scene/yaml.h"

namespace mortise::scene {

inline constexpr const char* kSet = "--set ";

// Puts the value of "a.b.c=value" into the tree, where the tables know such a path. Blocks with defaults (time, solver, ...)
// may be absent from the file; named things (bodies, effects, ...) and list entries must be there already, except that a whole
// effect can be added: "effects.gravity={}". `called`: what messages say in front of it.
void apply_override(Node& root, const std::string& text, const ParamTable& table, Diagnostics& errors, const std::string& called = kSet);

}  // namespace mortise::scene
