#include "geometry/refine.h"

#include "geometry/midsides.h"

namespace mortise::geometry {

TetMesh refined(const TetMesh& mesh) {
  TetMesh corners{mesh.points, {}};
  const auto node = [&](std::size_t t, int k) { return k < 4 ? mesh.tets[t].v[k] : mesh.midsides[t].v[k - 4]; };
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (int c = 0; c < kChildren; ++c) {
      Tet child;
      for (int k = 0; k < 4; ++k) child.v[k] = node(t, child_node(c, k));
      corners.tets.push_back(child);
    }
  TetMesh out = with_midsides(std::move(corners));
  for (std::size_t t = 0; t < out.tets.size(); ++t)
    for (int e = 0; e < 6; ++e) {
      const int child = static_cast<int>(t % kChildren);
      double a[4], b[4], l[4];
      tet_node(child_node(child, edge_begin(e)), a), tet_node(child_node(child, edge_end(e)), b);
      for (int k = 0; k < 4; ++k) l[k] = 0.5 * (a[k] + b[k]);
      Vec3 x = Vec3::Zero();
      for (int k = 0; k < 10; ++k) x += tet_shape_function(k, l) * mesh.points[node(t / kChildren, k)];
      out.points[out.midsides[t].v[e]] = x;
    }
  return out;
}

}  // namespace mortise::geometry
