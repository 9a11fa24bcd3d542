#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>

#include "base/hd.h"

namespace mortise {

using Index = std::int32_t;  // counts of nodes, elements, pairs; CSR offsets
using Vec2 = Eigen::Matrix<double, 2, 1>;
using Vec3 = Eigen::Matrix<double, 3, 1>;
using Mat2 = Eigen::Matrix<double, 2, 2>;
using Mat3 = Eigen::Matrix<double, 3, 3>;
using Vec12 = Eigen::Matrix<double, 12, 1>;
using Mat12 = Eigen::Matrix<double, 12, 12>;

// Plain index tuples (no padding, so arrays of them are arrays of Index).
struct Edge {
  Index v[2];
};
struct Triangle {
  Index v[3];
};
struct Tet {
  Index v[4];
};

}  // namespace mortise
