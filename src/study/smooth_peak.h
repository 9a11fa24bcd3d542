#pragma once
// The largest value of a field on a surface, without its scatter from node to node.
#include <array>
#include <cstdint>
#include <vector>

#include "base/types.h"

namespace mortise::study {

// Pressures of single nodes of linear elements scatter by some per cent around the field (as the triangles around them do), and the largest of them is
// as much too large. So a quadratic is fitted around every node, by least squares over the nodes up to two edges away on the same side of the body, each with its area (Zienkiewicz,
// Zhu, Int. J. Numer. Meth. Engng 33, 1992: patch recovery):
//
//   v(s, t) ~ c0 + c1 s + c2 t + c3 s^2 + c4 s t + c5 t^2,   s, t: in the plane across the normal there, from the node,
//
// and the largest c0 counts. A node with too few around it has its own value. triangles: of the surface; area: a third of the triangles around, of every
// point, 0 of points that are not on it.
double smooth_peak(const std::vector<std::array<std::int64_t, 3>>& triangles, const std::vector<Vec3>& points, const std::vector<double>& area,
                   const std::vector<double>& values);

}  // namespace mortise::study
