#pragma once
// What a joint, a bond or another tie is called.
#include <string>

#include "base/params.h"

namespace mortise::effects {

// `name` of its entry in the scene, without one those of its bodies.
inline std::string tie_name(const Params& entry) {
  if (const Params* name = entry.find("name")) return name->as_text();
  const Params* to = entry.find("to");
  return entry.text("body") + "_" + (to ? to->as_text() : "world");
}

}  // namespace mortise::effects
