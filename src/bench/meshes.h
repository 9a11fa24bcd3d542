#pragma once
// Deterministic meshes of the benchmarks. All tetrahedra are positively oriented.
#include <array>
#include <cstdint>
#include <vector>

#include "geometry/mesh.h"

namespace mortise::bench {

// Places of grid planes, ascending: `fine` cells of size h, then `coarse` cells growing geometrically to `end` [m].
// coarse = 0: h = end / fine.
std::vector<double> graded(double h, int fine, int coarse, double end);

// Grid planes 0 ... end as -end ... 0: downwards from a surface.
std::vector<double> mirrored(std::vector<double> z);
// Grid planes 0 ... 1 as 1 - t, ascending: fine at 1 instead of at 0.
std::vector<double> from_one(std::vector<double> t);

// How fine a mesh is at a contact spot at its origin: edges of length h in `fine` cells outwards and two downwards, then growing cells.
struct Spot {
  double h;  // [m]
  int fine, out, down;
  std::vector<double> outwards(double end) const { return graded(h, fine, out, end); }
  std::vector<double> downwards(double end) const { return mirrored(graded(h, 2, down, end)); }
  // For the other body: a little coarser, so that nodes do not coincide.
  Spot coarser() const { return {1.1 * h, static_cast<int>(fine / 1.1 + 0.5), out, down}; }
};

// Tensor-product block whose grid planes are x, y, z (ascending) [m].
geometry::TetMesh grid_block(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& z);

// Block between `lo` and `hi` with nx, ny, nz cells. Nodes are moved at random by up to jitter cells along every axis along
// which they are inside; faces stay plane, edges straight, corners where they are.
geometry::TetMesh jittered_block(const Vec3& lo, const Vec3& hi, const std::array<int, 3>& cells, double jitter, std::uint32_t seed);

// Octant x, y >= 0 >= z of the ball of this radius around the origin, from grid planes s (0 = axis ... 1 = rim of the cube) in
// both lateral directions and t (0 = centre ... 1 = pole at (0, 0, -radius)) downwards. Near the pole lateral lengths are
// radius s / sqrt(2) and depths radius (1 - t). Every tetrahedron has a vertex off the sphere, so none is flat.
geometry::TetMesh ball_octant(double radius, const std::vector<double>& s, const std::vector<double>& t);
geometry::TetMesh ball_octant(double radius, const Spot& at_pole);

// Quarter x >= 0 >= z of the cylinder of this radius around the y axis between the planes y; s and t as in ball_octant: near the line
// (0, y, -radius) lateral lengths are radius s / sqrt(2) and depths radius (1 - t).
geometry::TetMesh cylinder_quarter(double radius, const std::vector<double>& s, const std::vector<double>& t, const std::vector<double>& y);
geometry::TetMesh cylinder_quarter(double radius, const Spot& at_line, const std::vector<double>& y);

// Ring around the z axis between the planes z, at the radii r [m] and the angles from the x axis [rad], all ascending.
geometry::TetMesh ring_sector(const std::vector<double>& r, const std::vector<double>& angles, const std::vector<double>& z);
// Quarter x, y >= 0 of a ring with `cells` equal cells over the right angle.
geometry::TetMesh ring_quarter(const std::vector<double>& r, int cells, const std::vector<double>& z);

// The mesh with edges split in the middle, the longest of those that fit, until it has this many vertices and tetrahedra. An edge among k tetrahedra
// adds one and k; k is as near as there is to the tetrahedra over the vertices that are missing. Throws Error(Exit::internal) where that ends beside
// the mark.
geometry::TetMesh split_to(geometry::TetMesh mesh, std::size_t vertices, std::size_t tets);

// Upside down: z to height - z.
geometry::TetMesh upside_down(geometry::TetMesh mesh, double height = 0);

// Quarter x, y >= 0 of a punch of this radius around the z axis between its tip at the origin and z = height: `sectors` flat facets on
// its lower face, which rises by `rise` from the axis to the rim (0: a flat punch).
geometry::TetMesh punch_quarter(double radius, double rise, double height, int sectors);

}  // namespace mortise::bench
