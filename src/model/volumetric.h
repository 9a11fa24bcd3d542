#pragma once
// Which bodies resist a change of volume by averages (effects/elasticity/README.md): key `volumetric` of their material.
#include <algorithm>

#include "model/input.h"

namespace mortise::model {

// `auto` averages above this nu: below, elements hardly lock, and the averages' wider stencils buy little.
inline constexpr double kAveragedAbove = 0.4;

// Of an element of averages: what acts at its points, and what on means, of Lame's lambda [Pa].
struct Lambda {
  double at_points, of_mean;
};
// Quadratic elements resist at their points as if nu were this, and by their means what is beyond. By means alone they leave the changes of volume
// within an element to the shear modulus, and bend and sink too far (a cantilever of one element 16 %, of two 2 %); all at points, they lock.
inline constexpr double kNuAtPoints = 0.25;

inline Lambda lambda_of(double E, double nu, bool averaged, bool quadratic) {
  const double mu = E / (2 * (1 + nu)), all = 2 * mu * nu / (1 - 2 * nu);
  if (!averaged) return {all, 0};
  const double at_points = quadratic ? std::min(all, 2 * mu * kNuAtPoints / (1 - 2 * kNuAtPoints)) : 0;
  return {at_points, all - at_points};
}

// No corner of its elements is inside.
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
  return body.material.number("poisson_ratio") > kAveragedAbove;
}

}  // namespace mortise::model
