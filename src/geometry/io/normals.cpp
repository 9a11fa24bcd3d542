#include "geometry/io/normals.h"

#include <algorithm>
#include <cmath>

namespace mortise::geometry {

void complete_normals(VisualMesh& mesh, const std::vector<Index>& position, const std::vector<char>& has_normal) {
  Index positions = 0;
  for (Index p : position) positions = std::max(positions, p + 1);
  std::vector<Vec3> mean(positions, Vec3::Zero());
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = mesh.points[t.v[(k + 1) % 3]] - mesh.points[t.v[k]], b = mesh.points[t.v[(k + 2) % 3]] - mesh.points[t.v[k]];
      const Vec3 n = a.cross(b);
      mean[position[t.v[k]]] += std::atan2(n.norm(), a.dot(b)) * n.normalized();
    }
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    Vec3& n = mesh.normals[i];
    if (!has_normal[i] || !(n.norm() > 0)) n = mean[position[i]];
    n = n.norm() > 0 ? Vec3(n.normalized()) : Vec3(0, 0, 1);  // only where all triangles around are points or needles
  }
}

}  // namespace mortise::geometry
