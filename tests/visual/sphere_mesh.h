#pragma once
#include <array>
#include <map>
#include <vector>

#include "base/types.h"

namespace mortise::test {

// An octahedron whose triangles are split in four `levels` times, with all points on the sphere; outward.
struct SphereMesh {
  std::vector<Vec3> points{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<Triangle> triangles{{{0, 2, 4}}, {{2, 1, 4}}, {{1, 3, 4}}, {{3, 0, 4}}, {{2, 0, 5}}, {{1, 2, 5}}, {{3, 1, 5}}, {{0, 3, 5}}};

  SphereMesh(int levels, double radius) {
    for (int l = 0; l < levels; ++l) split();
    for (Vec3& p : points) p *= radius;
  }

 private:
  void split() {
    std::map<std::array<Index, 2>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [it, fresh] = middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<Index>(points.size()));
      if (fresh) points.push_back((points[a] + points[b]).normalized());
      return it->second;
    };
    std::vector<Triangle> finer;
    for (const Triangle& t : triangles) {
      const Index a = middle(t.v[0], t.v[1]), b = middle(t.v[1], t.v[2]), c = middle(t.v[2], t.v[0]);
      finer.insert(finer.end(), {{{t.v[0], a, c}}, {{a, t.v[1], b}}, {{c, b, t.v[2]}}, {{a, b, c}}});
    }
    triangles = finer;
  }
};

}  // namespace mortise::test
