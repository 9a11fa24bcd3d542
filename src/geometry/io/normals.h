#pragma once
#include <vector>

#include "geometry/mesh.h"

namespace mortise::geometry {

// Normalises the normals that are there and computes the others: the mean of the adjacent triangles' normals, weighted with
// the angle at the vertex (Thuermer & Wuethrich 1998). Vertices with the same `position` id share one normal.
void complete_normals(VisualMesh& mesh, const std::vector<Index>& position, const std::vector<char>& has_normal);

}  // namespace mortise::geometry
