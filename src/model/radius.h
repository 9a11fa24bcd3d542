#pragma once
#include <algorithm>
#include <span>

#include "model/points_of.h"

namespace mortise::model {

// Distance of the body's farthest point from its centre of mass at rest [m]; rest: of all points of the model.
inline double radius(const Body& body, std::span<const Vec3> rest) {
  double farthest = 0;
  for (const Vec3& x : points_of(body, rest)) farthest = std::max(farthest, (x - body.centre).norm());
  return farthest;
}

}  // namespace mortise::model
