#pragma once
#include <vector>

#include "base/types.h"

namespace mortise::solver {

// x, y, z of one after the other.
inline std::vector<double> flatten(const std::vector<Vec3>& v) {
  std::vector<double> out;
  out.reserve(3 * v.size());
  for (const Vec3& x : v) out.insert(out.end(), {x[0], x[1], x[2]});
  return out;
}

}  // namespace mortise::solver
