#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "base/params.h"
#include "base/types.h"

namespace mortise::geometry {

// x -> R x + t, as a block with `position` and perhaps `rotation` says.
struct Placement {
  Mat3 R = Mat3::Identity();
  Vec3 t = Vec3::Zero();

  explicit Placement(const Params& block) : t(block.vec3("position")) {
    if (const Params* rotation = block.find("rotation"))
      R = Eigen::AngleAxisd(rotation->number("angle"), rotation->vec3("axis").normalized()).toRotationMatrix();
  }
  Vec3 operator()(const Vec3& x) const { return R * x + t; }
  void apply(std::vector<Vec3>& points) const {
    for (Vec3& x : points) x = (*this)(x);
  }
};

}  // namespace mortise::geometry
