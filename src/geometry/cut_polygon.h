#pragma once
// What is left of a convex polygon where a linear function is not negative (Sutherland, Hodgman, Comm. ACM 17, 1974).
#include <vector>

namespace mortise::geometry {

// `value` of a point; a corner at which it is zero stays.
template <class Point, class Value>
std::vector<Point> cut(const std::vector<Point>& polygon, const Value& value) {
  std::vector<Point> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double va = value(a), vb = value(b);
    if (va >= 0) kept.push_back(a);
    if ((va > 0 && vb < 0) || (va < 0 && vb > 0)) kept.push_back(a + va / (va - vb) * (b - a));
  }
  return kept;
}

}  // namespace mortise::geometry
