#include "geometry/midsides.h"

#include <algorithm>
#include <utility>

#include "geometry/quadratic.h"
#include "geometry/topology.h"

namespace mortise::geometry {
namespace {

using Key = std::pair<Index, Index>;

Key key(Index a, Index b) { return std::minmax(a, b); }

std::vector<Key> edges_of(const std::vector<Tet>& tets) {
  std::vector<Key> edges;
  edges.reserve(6 * tets.size());
  for (const Tet& t : tets)
    for (int e = 0; e < 6; ++e) edges.push_back(key(t.v[edge_begin(e)], t.v[edge_end(e)]));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

}  // namespace

TetMesh with_midsides(TetMesh mesh, const Snap& snap) {
  const std::vector<Key> edges = edges_of(mesh.tets);
  const auto first = static_cast<Index>(mesh.points.size());
  const auto place = [&](Index a, Index b) { return std::lower_bound(edges.begin(), edges.end(), key(a, b)) - edges.begin(); };
  for (const auto& [a, b] : edges) mesh.points.push_back(0.5 * (mesh.points[a] + mesh.points[b]));
  if (snap)
    for (const Edge& e : unique_edges(boundary_triangles(mesh))) {
      Vec3& middle = mesh.points[first + place(e.v[0], e.v[1])];
      middle = snap(mesh.points[e.v[0]], mesh.points[e.v[1]], middle);
    }
  mesh.midsides.clear();
  for (const Tet& t : mesh.tets) {
    Midsides m;
    for (int e = 0; e < 6; ++e) m.v[e] = first + static_cast<Index>(place(t.v[edge_begin(e)], t.v[edge_end(e)]));
    mesh.midsides.push_back(m);
  }
  return mesh;
}

std::vector<Face> boundary_faces(const TetMesh& mesh) {
  std::vector<std::pair<Key, Index>> middle;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (int e = 0; e < 6; ++e) middle.emplace_back(key(mesh.tets[t].v[edge_begin(e)], mesh.tets[t].v[edge_end(e)]), mesh.midsides[t].v[e]);
  std::sort(middle.begin(), middle.end());
  std::vector<Face> out;
  for (const Triangle& t : boundary_triangles(mesh)) {
    Face f{{t.v[0], t.v[1], t.v[2], -1, -1, -1}};
    for (int e = 0; e < 3; ++e) {
      const Key edge = key(t.v[edge_begin(e)], t.v[edge_end(e)]);
      f.v[3 + e] = std::lower_bound(middle.begin(), middle.end(), std::pair(edge, Index(-1)))->second;
    }
    out.push_back(f);
  }
  return out;
}

std::vector<Triangle> quarters(const std::vector<Face>& faces) {
  std::vector<Triangle> out;
  out.reserve(4 * faces.size());
  for (const Face& f : faces)
    for (int q = 0; q < 4; ++q) out.push_back({{f.v[quarter_node(q, 0)], f.v[quarter_node(q, 1)], f.v[quarter_node(q, 2)]}});
  return out;
}

}  // namespace mortise::geometry
