#pragma once
#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "base/types.h"

namespace mortise::geometry {

// Binary tree of boxes over triangles, split at the middle of the longest side. Points and triangles are the caller's, and stay. On the host.
class NearestTriangle {
 public:
  NearestTriangle(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);

  // Number of the triangle nearest to p. Where several are equally near (a vertex or edge is nearest), the one that faces p most. -1: there is none.
  Index nearest(const Vec3& p) const { return find(p).triangle; }
  double distance(const Vec3& p) const { return std::sqrt(find(p).distance2); }  // from it; infinite where there is none

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    Index first, count;  // triangles of a leaf; count = 0 inside
    Index right;         // the left child follows its parent
  };

  struct Found {
    Index triangle = -1;
    double distance2 = INFINITY, facing = -1;
  };

  Index build(Index first, Index last);
  Found find(const Vec3& p) const;
  void search(Index id, const Vec3& p, Found& best) const;
  Vec3 middle(Index t) const { return (points_[triangles_[t].v[0]] + points_[triangles_[t].v[1]] + points_[triangles_[t].v[2]]) / 3; }

  const std::vector<Vec3>& points_;
  const std::vector<Triangle>& triangles_;
  std::vector<Index> order_;
  std::vector<Node> nodes_;
};

}  // namespace mortise::geometry
