#pragma once
#include <vector>

#include "base/params.h"

namespace mortise::run {

// Entries of an effect that is a list, such as `pin`; none where the scene does not name it. effects: the block of that name.
inline std::vector<Params> entries(const Params& effects, const char* effect) {
  const Params* list = effects.find(effect);
  return list ? list->items() : std::vector<Params>();
}

}  // namespace mortise::run
