#pragma once
// What a joint may have to move or bear at most, in order of magnitude: the mass of all bodies of its environment [kg], and how far points of the two
// that it joins are from it [m].
#include <algorithm>
#include <vector>

#include "model/model.h"

namespace mortise::effects::joint {

struct Usual {
  double mass = 0, lever = 0;
  double weight() const { return 9.81 * mass; }  // [N]
};

inline Usual usual(const model::Model& model, const model::Joint& j) {
  Usual out;
  const std::vector<Vec3> rest = model.rest_points.download();
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const model::Body& body = model.bodies[b];
    if (body.env != j.env) continue;
    out.mass += body.mass;
    if (static_cast<Index>(b) != j.body && static_cast<Index>(b) != j.to) continue;
    for (Index p = body.point_begin; p < body.point_end; ++p) out.lever = std::max(out.lever, (rest[p] - j.place).norm());
  }
  return out;
}

}  // namespace mortise::effects::joint
