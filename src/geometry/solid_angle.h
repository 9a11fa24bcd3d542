#pragma once
#include <cmath>

#include "base/types.h"

namespace mortise::geometry {

// Under which (a, b, c) is seen from x, positive from behind [sr]: over all triangles of a closed surface 4 pi for every time that it winds around x
// (Van Oosterom, Strackee, IEEE Trans. Biomed. Eng. 30, 1983).
inline double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  const Vec3 A = a - x, B = b - x, C = c - x;
  const double la = A.norm(), lb = B.norm(), lc = C.norm();
  return 2 * std::atan2(A.cross(B).dot(C), la * lb * lc + A.dot(B) * lc + B.dot(C) * la + C.dot(A) * lb);
}

}  // namespace mortise::geometry
