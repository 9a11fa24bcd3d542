#pragma once
#include "geometry/mesh.h"

namespace mortise::geometry {

// The convex hull of points, outward. Throws Error(Exit::scene) where they lie in a plane.
TriMesh convex_hull(const std::vector<Vec3>& points);

}  // namespace mortise::geometry
