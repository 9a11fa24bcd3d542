#pragma once
#include <Eigen/Dense>

#include "base/types.h"

namespace mortise::audit {

// The affine map from places to vectors that is nearest to those of n points (least squares): its value at the origin, and its slopes.
template <class Place, class Value>
Eigen::Matrix<double, 4, 3> nearest_affine(std::size_t n, const Place& place, const Value& value) {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> right = Eigen::Matrix<double, 4, 3>::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    Eigen::Vector4d row;
    row << 1, place(i);
    normal += row * row.transpose();
    right += row * value(i).transpose();
  }
  return normal.ldlt().solve(right);
}

}  // namespace mortise::audit
