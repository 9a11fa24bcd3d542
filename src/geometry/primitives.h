#pragma once
// Structured, deterministic tetrahedral meshes of simple bodies, centred at the origin. Vertices that belong to a curved
// surface lie on it. `edge_length` is the size of a grid cell [m]; the number of cells is rounded to the nearest integer >= 1.
#include <array>

#include "geometry/mesh.h"

namespace mortise::geometry {

// Axis-aligned box with side lengths `size` [m]. Every cell is split the same way (Kuhn), so inside a face each vertex
// has six triangles and all vertices carry the same area.
TetMesh box(const Vec3& size, double edge_length);
TetMesh box(const Vec3& size, const std::array<Index, 3>& cells);

TetMesh sphere(double radius, double edge_length);
TetMesh cylinder(double radius, double height, double edge_length);  // axis z
// Axis z; `height` is the distance between the centres of the two half spheres, so the body is height + 2 radius long.
TetMesh capsule(double radius, double height, double edge_length);

}  // namespace mortise::geometry
