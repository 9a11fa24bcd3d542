#pragma once
#include <string>
#include <string_view>

#include "geometry/mesh.h"

namespace mortise::geometry {

struct PlyFile {
  std::vector<Vec3> points;
  std::vector<Vec3> normals;        // one per point, or none
  std::vector<Vec2> uvs;            // one per point, or none
  std::vector<Triangle> triangles;  // polygons are cut into fans
};

// ASCII and binary PLY of either byte order (Turk, "The PLY polygon file format", 1994): of element `vertex` x y z, nx ny nz, and s t (also u v,
// texture_u texture_v); of element `face` the list vertex_indices (also vertex_index). Everything else is passed over. Errors name the file and the
// line or byte.
PlyFile parse_ply(const std::string& path, std::string_view bytes);

TriMesh surface_from(PlyFile ply);
VisualMesh visual_from(const std::string& path, const PlyFile& ply);

}  // namespace mortise::geometry
