#pragma once
// Which bodies resist a change of volume by averages (effects/elasticity/README.md): key `volumetric` of their material.
#include <algorithm>

#include "model/input.h"

namespace mortise::model {

// `auto` averages above this nu: below, elements hardly lock, and the averages' wider stencils buy little.
inline constexpr double kAveragedAbove = 0.4;

// No corner of its elements is inside: they have one pressure from face to face, and average away what would resist a bending of quadratic ones (a
// cantilever sinks 12 % too far; 7 % too little without averages, and none of both with two elements across).
inline bool one_across(const BodyInput& body) {
  std::vector<bool> outside(body.nodes.size(), false);
  for (const Triangle& t : body.triangles)
    for (const Index v : t.v) outside[static_cast<std::size_t>(v)] = true;
  return std::all_of(body.tets.begin(), body.tets.end(), [&](const Tet& t) {
    return std::all_of(std::begin(t.v), std::end(t.v), [&](Index v) { return outside[static_cast<std::size_t>(v)]; });
  });
}

inline bool averages_volume(const BodyInput& body) {
  const Params* key = body.material.find("volumetric");
  const std::string wanted = key ? key->as_text() : "auto";
  if (wanted != "auto") return wanted == "averaged";
  return body.material.number("poisson_ratio") > kAveragedAbove && (body.midsides.empty() || !one_across(body));
}

}  // namespace mortise::model
