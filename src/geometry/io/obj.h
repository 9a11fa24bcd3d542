#pragma once
#include <string>
#include <string_view>

#include "geometry/mesh.h"

namespace mortise::geometry {

// A Wavefront OBJ file with its own indices: positions, texture coordinates and normals stay separate lists.
struct ObjFile {
  struct Corner {
    Index v, t, n;  // t, n: -1 where the file gives none
  };
  struct Face {
    Corner corner[3];
    Index material, part;
  };
  std::vector<Vec3> points, normals;
  std::vector<Vec2> uvs;
  std::vector<Face> faces;                // polygons are cut into fans
  std::vector<VisualMaterial> materials;  // from the MTL files (Kd, map_Kd, Pr, Pm); unknown names get the default look
};

// Errors (Exit::scene) name file and line; a material library that is missing is Exit::file.
ObjFile read_obj(const std::string& path);
// With `materials` off the MTL files are not opened (simulation surfaces do not need them).
ObjFile parse_obj(const std::string& path, std::string_view text, bool materials);

TriMesh surface_from(const ObjFile& obj);
VisualMesh visual_from(const ObjFile& obj);

std::string obj_text(const TriMesh& mesh);
void write_obj(const std::string& path, const TriMesh& mesh);

}  // namespace mortise::geometry
