#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "base/types.h"

namespace mortise::geometry {

// Closest point of triangle (a, b, c) to p.
Vec3 closest_point(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

// Binary tree of boxes over triangles, split at the middle of the longest side. Points and triangles are the caller's, and stay. On the host.
class NearestTriangle {
 public:
  NearestTriangle(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);

  // Number of the triangle nearest to p. Where several are equally near (a vertex or edge is nearest), the one that faces p most. -1: there is none.
  Index nearest(const Vec3& p) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    Index first, count;  // triangles of a leaf; count = 0 inside
    Index right;         // the left child follows its parent
  };

  Index build(Index first, Index last);
  void search(Index id, const Vec3& p, Index& best, double& distance2, double& facing) const;
  Vec3 middle(Index t) const { return (points_[triangles_[t].v[0]] + points_[triangles_[t].v[1]] + points_[triangles_[t].v[2]]) / 3; }

  const std::vector<Vec3>& points_;
  const std::vector<Triangle>& triangles_;
  std::vector<Index> order_;
  std::vector<Node> nodes_;
};

}  // namespace mortise::geometry
