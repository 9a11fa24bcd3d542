#include "geometry/nearest_triangle.h"

#include <algorithm>
#include <numeric>

namespace mortise::geometry {
namespace {

// Closest point of triangle (a, b, c) to p: clamps to the edges where the projection falls outside.
Vec3 closest_point(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto on_edge = [&](const Vec3& s, const Vec3& e) -> Vec3 {
    const Vec3 d = e - s;
    const double length2 = d.squaredNorm();
    const double t = length2 > 0 ? std::clamp((p - s).dot(d) / length2, 0.0, 1.0) : 0.0;
    return s + t * d;
  };
  const Vec3 n = (b - a).cross(c - a);
  const bool ab = n.dot((b - a).cross(p - a)) >= 0, bc = n.dot((c - b).cross(p - b)) >= 0, ca = n.dot((a - c).cross(p - c)) >= 0;
  if (ab && bc && ca && n.squaredNorm() > 0) return p - n * (n.dot(p - a) / n.squaredNorm());
  Vec3 best = on_edge(a, b);
  for (const Vec3& q : {on_edge(b, c), on_edge(c, a)})
    if ((p - q).squaredNorm() < (p - best).squaredNorm()) best = q;
  return best;
}

}  // namespace

NearestTriangle::NearestTriangle(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles)
    : points_(points), triangles_(triangles), order_(triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  if (!order_.empty()) build(0, static_cast<Index>(order_.size()));
}

NearestTriangle::Found NearestTriangle::find(const Vec3& p) const {
  Found best;
  if (!nodes_.empty()) search(0, p, best);
  return best;
}

Index NearestTriangle::build(Index first, Index last) {
  const Index id = static_cast<Index>(nodes_.size());
  nodes_.push_back({{}, first, 0, 0});
  Eigen::AlignedBox3d box, middles;
  for (Index i = first; i < last; ++i) {
    for (const Index v : triangles_[order_[i]].v) box.extend(points_[v]);
    middles.extend(middle(order_[i]));
  }
  nodes_[id].box = box;
  if (last - first <= 4) {
    nodes_[id].count = last - first;
    return id;
  }
  int axis = 0;
  middles.sizes().maxCoeff(&axis);
  const Index half = (first + last) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + half, order_.begin() + last, [&](Index a, Index b) {
    const double x = middle(a)[axis], y = middle(b)[axis];
    return x < y || (x == y && a < b);
  });
  build(first, half);
  const Index right = build(half, last);
  nodes_[id].right = right;
  return id;
}

void NearestTriangle::search(Index id, const Vec3& p, Found& best) const {
  const Node& node = nodes_[id];
  if (node.box.squaredExteriorDistance(p) > best.distance2 * (1 + 1e-9)) return;
  if (node.count == 0) {
    Index near = id + 1, far = node.right;
    if (nodes_[near].box.squaredExteriorDistance(p) > nodes_[far].box.squaredExteriorDistance(p)) std::swap(near, far);
    search(near, p, best);
    search(far, p, best);
    return;
  }
  for (Index i = node.first; i < node.first + node.count; ++i) {
    const Triangle& t = triangles_[order_[i]];
    const Vec3 &a = points_[t.v[0]], &b = points_[t.v[1]], &c = points_[t.v[2]];
    const Vec3 gap = p - closest_point(p, a, b, c), n = (b - a).cross(c - a).normalized();
    const double d2 = gap.squaredNorm(), f = std::abs(n.dot(gap));
    const double slack = 1e-9 * best.distance2 + 1e-300;
    const bool nearer = d2 < best.distance2 - slack, tie = !nearer && d2 <= best.distance2 + slack;
    const bool faces = f > best.facing * (1 + 1e-9) || (f >= best.facing * (1 - 1e-9) && order_[i] < best.triangle);
    if (nearer || best.triangle < 0 || (tie && faces)) best = {order_[i], std::min(best.distance2, d2), f};
  }
}

}  // namespace mortise::geometry
