#pragma once
// Quadratic tetrahedra from linear ones, and their surface.
#include <functional>

#include "geometry/mesh.h"

namespace mortise::geometry {

// Where the node in the middle of an edge of the surface goes, from its end points and their mean.
using Snap = std::function<Vec3(const Vec3& a, const Vec3& b, const Vec3& middle)>;

// One node per edge, after the points of `mesh` in the order of the sorted edges. Edges are straight; `snap`, if given, moves the
// middles of edges on the surface.
TetMesh with_midsides(TetMesh mesh, const Snap& snap = {});

// The faces that bound a quadratic mesh, outward, in the order of boundary_triangles().
std::vector<Face> boundary_faces(const TetMesh& mesh);
// The four quarters of every face, face after face (quadratic.h).
std::vector<Triangle> quarters(const std::vector<Face>& faces);

}  // namespace mortise::geometry
