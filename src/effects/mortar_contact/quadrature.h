#pragma once
// Gauss rules on a segment with 1, 2 and 3 points, exact for polynomials of degree 1, 3, 5; weights add up to 1. The rules on triangles
// are geometry's.
#include "geometry/triangle_rule.h"

namespace mortise::effects::mortar {

using geometry::triangle_point;
using geometry::TrianglePoint;

struct SegmentPoint {
  double t;  // 0..1
  double weight;
};
// Number of points that goes with a triangle rule of n.
MORTISE_HD inline int segment_points(int n) { return n == 1 ? 1 : n == 3 ? 2 : 3; }
MORTISE_HD inline SegmentPoint segment_point(int n, int i) {
  if (n == 1) return {0.5, 1};
  if (n == 2) return {i == 0 ? 0.21132486540518711775 : 0.78867513459481288225, 0.5};
  if (i == 1) return {0.5, 4.0 / 9};
  return {i == 0 ? 0.11270166537925831148 : 0.88729833462074168852, 5.0 / 18};
}

}  // namespace mortise::effects::mortar
