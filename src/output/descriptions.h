#pragma once
#include <string_view>

namespace mortise::output {

// What a group of /mortise/effects holds, and what a dataset of it does; "" where this is not known. `group` is "" for fields of points and cells.
// schemas/fields.md and the READMEs of effects say more.
std::string_view description(std::string_view group);
std::string_view description(std::string_view group, std::string_view name);

}  // namespace mortise::output
