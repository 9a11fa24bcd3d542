#pragma once
#include <algorithm>
#include <span>

#include "model/model.h"

namespace mortise::model {

// Distance of the body's farthest point from its centre of mass at rest [m]; rest: of all points of the model.
inline double radius(const Body& body, std::span<const Vec3> rest) {
  double farthest = 0;
  for (Index p = body.point_begin; p < body.point_end; ++p) farthest = std::max(farthest, (rest[p] - body.centre).norm());
  return farthest;
}

}  // namespace mortise::model
