#pragma once
#include <string>
#include <string_view>

#include "geometry/mesh.h"

namespace mortise::geometry {

// A Gmsh file: nodes in file order, triangles and tetrahedra of first or second order; points and lines are passed over. The
// middles of second-order triangles are not kept.
struct MshFile {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  std::vector<Tet> tets;
  std::vector<Midsides> midsides{};  // one per tetrahedron of a second-order file
};

// Gmsh ASCII formats 2.x and 4.1 (Gmsh reference manual, "MSH file format"). Errors name file and line.
MshFile read_msh(const std::string& path);
MshFile parse_msh(const std::string& path, std::string_view text);  // `path` for messages

// Format 2.2, coordinates with as many digits as needed: what is read back has the same bits.
void write_msh(const std::string& path, const TetMesh& mesh);
void write_msh(const std::string& path, const MshFile& mesh);

}  // namespace mortise::geometry
