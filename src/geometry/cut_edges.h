#pragma once
#include <functional>

#include "geometry/mesh.h"

namespace mortise::geometry {

// Cuts the edges of a closed surface that are longer than `longest` [m] in the middle, the longest first, with the triangles on both sides of them:
// edges of triangles of which `wanted` says so; pieces are asked for anew. The shape stays as it is, and the surface closed.
void cut_edges(TriMesh& mesh, double longest, const std::function<bool(const Vec3 (&corner)[3])>& wanted);

}  // namespace mortise::geometry
