#pragma once
// Structured, deterministic tetrahedral meshes of simple bodies, centred at the origin. Vertices that belong to a curved
// surface lie on it. `edge_length` is the size of a grid cell [m]. An axis has the even number of cells that is nearest to it, or a single cell
// where the length is below 1.5 edge_length: with even numbers the mesh is its own mirror image about all three middle planes, to the last bit.
#include <array>
#include <functional>

#include "geometry/mesh.h"

namespace mortise::geometry {

// `n` cells along the axes, and where the vertices of theirs lie, c = 0..n.
struct Grid {
  using Cell = std::array<Index, 3>;
  Cell n;
  std::function<Vec3(const Cell& c)> place;
};

// Axis-aligned box with side lengths `size` [m]. Neighbouring cells are split as mirror images of each other (Kuhn): diagonals of one way would
// bend the body's answer to a load towards it, and lock five times as much near nu = 0.5. An odd number of cells has a middle layer whose split
// is not its own mirror image; all else is.
Grid box_grid(const Vec3& size, double edge_length, Index single = 1);  // single: so many cells where one would do
Grid box_grid(const Vec3& size, const std::array<Index, 3>& cells);
Grid sphere_grid(double radius, double edge_length);
Grid cylinder_grid(double radius, double height, double edge_length);  // axis z
// Axis z; `height` is the distance between the centres of the two half spheres, so the body is height + 2 radius long.
Grid capsule_grid(double radius, double height, double edge_length);

// Tetrahedra; and the surface of these alone, which is found without them: surface_of(solid(grid)) to the last bit.
TetMesh solid(const Grid& grid);
TriMesh skin(const Grid& grid);

TetMesh box(const Vec3& size, double edge_length);
TetMesh box(const Vec3& size, const std::array<Index, 3>& cells);
TetMesh sphere(double radius, double edge_length);
TetMesh cylinder(double radius, double height, double edge_length);
TetMesh capsule(double radius, double height, double edge_length);

}  // namespace mortise::geometry
