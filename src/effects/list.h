#pragma once
// The one visible list of effects. A new effect is one folder, one line in list.cpp and one test file.
#include <functional>
#include <vector>

#include "effects/effect.h"

namespace mortise::effects {

using KindList = std::vector<std::reference_wrapper<const Kind>>;

const KindList& list();  // in the order in which effects act within a step
// Adds a kind that lives elsewhere, and for as long as the program: tests do. It acts last.
void add(const Kind& kind);
// The kind of that name; nullptr if there is none.
const Kind* find_kind(std::string_view name);

}  // namespace mortise::effects
