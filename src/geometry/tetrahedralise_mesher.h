#pragma once
#include "geometry/tetrahedralise.h"

namespace mortise::geometry {

// The CGAL call alone: all options set, surface already checked, result unchecked (empty if nothing was found to fill).
TetMesh mesh_domain(const TriMesh& surface, const TetrahedraliseOptions& options);

}  // namespace mortise::geometry
