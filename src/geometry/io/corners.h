#pragma once
#include <array>
#include <map>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace mortise::geometry {

// Puts together the mesh that is drawn from corners of triangles that carry their own position, normal and texture coordinates: corners of one part
// that agree in all of them become one vertex. Errors: coordinates that are not finite.
class CornerCollector {
 public:
  explicit CornerCollector(std::string path) : path_(std::move(path)) {}

  // A normal that is zero or not finite is one that the file does not give.
  Index vertex(Index part, const Vec3& position, const Vec3& normal, const Vec2& uv);
  void triangle(Index part, Index material, const Triangle& corners);

  // Normals that were not given are the mean of the triangles around the position.
  VisualMesh finish(std::vector<VisualMaterial> materials, bool has_uvs);

 private:
  std::string path_;
  VisualMesh mesh_;
  std::map<std::array<double, 3>, Index> positions_;
  std::map<std::array<double, 7>, Index> vertices_;  // part, position, normal, uv
  std::vector<Index> position_;                      // of each vertex
  std::vector<char> has_normal_;
};

}  // namespace mortise::geometry
