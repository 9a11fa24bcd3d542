#pragma once
#include "geometry/mesh.h"

namespace mortise::geometry {

// The convex hull of points, outward, without triangles that have no height: points that lie off the hull of the others by less than some 1e-6 of its
// size are left out. Throws Error(Exit::scene) where all lie in a plane.
TriMesh convex_hull(const std::vector<Vec3>& points);

}  // namespace mortise::geometry
