#pragma once
// Which bodies resist a change of volume by averages (effects/elasticity/README.md): key `volumetric` of their material.
#include "base/params.h"

namespace mortise::model {

// `auto` averages above this nu: below, elements hardly lock, and the averages' wider stencils buy little.
inline constexpr double kAveragedAbove = 0.4;

inline bool averages_volume(const Params& material) {
  const Params* key = material.find("volumetric");
  const std::string wanted = key ? key->as_text() : "auto";
  return wanted == "auto" ? material.number("poisson_ratio") > kAveragedAbove : wanted == "averaged";
}

}  // namespace mortise::model
