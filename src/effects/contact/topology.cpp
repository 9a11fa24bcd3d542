#include "effects/contact/topology.h"

#include <algorithm>
#include <map>

namespace mortise::effects::contact {
namespace {

// Rows of `values`, row r holding those with row[i] == r, in order.
void rows(Index n, const std::vector<Index>& row, const std::vector<Index>& values, Buffer<Index>& offset_out, Buffer<Index>& values_out) {
  std::vector<Index> offset(n + 1, 0), sorted(values.size());
  for (Index r : row) ++offset[r + 1];
  for (Index r = 0; r < n; ++r) offset[r + 1] += offset[r];
  std::vector<Index> next = offset;
  for (std::size_t i = 0; i < row.size(); ++i) sorted[next[row[i]]++] = values[i];
  offset_out.upload(offset);
  values_out.upload(sorted);
}

}  // namespace

Topology::Topology(const geometry::Surface& surface, Index points) {
  const std::vector<Triangle> triangles = surface.triangles.download();
  const std::vector<Edge> edges = surface.edges.download();
  std::map<std::pair<Index, Index>, Index> edge_of;
  std::vector<Index> count(points, 0);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    edge_of[{edges[e].v[0], edges[e].v[1]}] = static_cast<Index>(e);
    ++count[edges[e].v[0]], ++count[edges[e].v[1]];
  }
  std::vector<Index> sides, corners, owner;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Index a = triangles[t].v[k], b = triangles[t].v[(k + 1) % 3];
      sides.push_back(edge_of.at({std::min(a, b), std::max(a, b)}));
      corners.push_back(a);
      owner.push_back(static_cast<Index>(t));
    }
  triangle_edge.upload(sides);
  rows(static_cast<Index>(edges.size()), sides, owner, edge_offset, edge_triangle);
  rows(points, corners, owner, point_offset, point_triangle);
  point_edges.upload(count);
}

}  // namespace mortise::effects::contact
