#pragma once
#include <span>

#include "model/model.h"

namespace mortise::model {

// Those of a body among the places of all points of the model.
inline std::span<const Vec3> points_of(const Body& body, std::span<const Vec3> all) {
  return all.subspan(body.point_begin, body.point_end - body.point_begin);
}

}  // namespace mortise::model
