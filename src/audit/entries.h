#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/params.h"
#include "effects/tie_name.h"

namespace mortise::audit {

// Entries of an effect that is a list, such as `pin`; none where the scene does not name it. effects: the block of that name.
inline std::vector<Params> entries(const Params& effects, const char* effect) {
  const Params* list = effects.find(effect);
  return list ? list->items() : std::vector<Params>();
}

inline std::optional<Params> joint_named(const Params& effects, const std::string& name) {
  for (const Params& joint : entries(effects, "joint"))
    if (effects::tie_name(joint) == name) return joint;
  return {};
}

}  // namespace mortise::audit
