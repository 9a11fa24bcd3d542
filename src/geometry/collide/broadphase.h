#pragma once
// Which point-triangle and edge-edge pairs may come within a radius of each other.
#include <vector>

#include "device/device.h"
#include "geometry/collide/bvh.h"
#include "geometry/surface.h"

namespace mortise::geometry {

struct PointTriangle {
  Index point, triangle;  // point id; index into surface.triangles
  Index v[4];             // points {p, t0, t1, t2}
};
struct EdgeEdge {
  Index a, b;  // indices into surface.edges, a < b
  Index v[4];  // points {a0, a1, b0, b1}
};

// All pairs whose boxes, swept from y to y + dy and grown by radius/2, overlap; without pairs that share a point and pairs that
// the surface does not watch, and of one body without those that stay farther apart than the radius (broadphase.cpp). Sorted by environment, then by
// the two ids. Exactly what testing all pairs would find.
class Broadphase {
 public:
  // Keeps a reference to the surface, whose points and primitives must not change.
  explicit Broadphase(const Surface& surface);

  // y, dy [m]: one per point of the surface; dy may be empty (bodies at rest). radius >= 0 [m]. Throws Error(Exit::device) when
  // there are more pairs than can be counted.
  void update(device::View<const Vec3> y, device::View<const Vec3> dy, double radius);

  device::View<const PointTriangle> point_triangles() const { return point_triangles_.view(); }
  device::View<const EdgeEdge> edge_edges() const { return edge_edges_.view(); }
  // Pairs of environment e are [offset[e], offset[e+1]); as many environments as the surface's points have.
  const std::vector<Index>& pt_env_offset() const { return pt_env_offset_; }
  const std::vector<Index>& ee_env_offset() const { return ee_env_offset_; }

 private:
  const Surface& surface_;
  Index environments_ = 0;
  device::Buffer<Index> points_, edges_;                  // queries in canonical order: environment, then id
  device::Buffer<Index> point_env_first_, edge_env_first_;  // first query of each environment
  device::Buffer<Index> pt_counts_, pt_noted_, ee_counts_, ee_noted_;  // scratch of update
  Bvh triangle_tree_, edge_tree_;
  device::Buffer<PointTriangle> point_triangles_;
  device::Buffer<EdgeEdge> edge_edges_;
  std::vector<Index> pt_env_offset_, ee_env_offset_;
};

}  // namespace mortise::geometry
