// Parts of a closed surface inside of each other.
#include <cmath>
#include <numeric>

#include "geometry/solid_angle.h"
#include "geometry/topology_check.h"

namespace mortise::geometry {
namespace {

struct Part {
  std::vector<Index> triangles;
  Eigen::AlignedBox3d box;
  double volume = 0;  // times 6, signed [m^3]
};

// Triangles that hang together, by their vertices.
std::vector<Part> parts_of(const TriMesh& mesh) {
  std::vector<Index> root(mesh.points.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](Index v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const Triangle& t : mesh.triangles)
    for (int k = 1; k < 3; ++k) root[find(t.v[k])] = find(t.v[0]);
  std::vector<Part> parts;
  std::vector<Index> number(mesh.points.size(), -1);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    Index& part = number[find(t.v[0])];
    if (part < 0) part = static_cast<Index>(parts.size()), parts.emplace_back();
    Part& p = parts[part];
    p.triangles.push_back(static_cast<Index>(i));
    for (Index v : t.v) p.box.extend(mesh.points[v]);
    const Vec3& o = mesh.points[mesh.triangles[p.triangles[0]].v[0]];
    p.volume += (mesh.points[t.v[0]] - o).cross(mesh.points[t.v[1]] - o).dot(mesh.points[t.v[2]] - o);
  }
  return parts;
}

// How often the part winds around x.
int winding(const TriMesh& mesh, const Part& part, const Vec3& x) {
  double angle = 0;
  for (Index i : part.triangles) {
    const Index* v = mesh.triangles[i].v;
    angle += solid_angle(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], x);
  }
  return static_cast<int>(std::lround(angle / (4 * M_PI)));
}

}  // namespace

// Across a part that faces outwards the winding number w of all parts rises by one on the way in, across a cavity it falls. It is 0 outside and
// 1 inside of a body, so the others must wind 0 times around a part that faces outwards, and once around a cavity.
Index first_wrongly_nested(const TriMesh& mesh) {
  const std::vector<Part> parts = parts_of(mesh);
  if (parts.size() < 2) return -1;
  for (const Part& p : parts) {
    const Vec3& x = mesh.points[mesh.triangles[p.triangles[0]].v[0]];
    int around = 0;
    for (const Part& other : parts)
      if (&other != &p && other.box.contains(x)) around += winding(mesh, other, x);
    if (around != (p.volume > 0 ? 0 : 1)) return p.triangles[0];
  }
  return -1;
}

}  // namespace mortise::geometry
