#include "visual/mapper.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "base/error.h"

namespace mortise::visual {
namespace {

using Box = Eigen::AlignedBox3d;

// Closest point of triangle (a, b, c) to p: clamps to the edges where the projection falls outside.
Vec3 closest(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
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

// Binary tree of boxes over triangles, split at the middle of the longest side.
class Tree {
 public:
  Tree(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) : points_(points), triangles_(triangles), order_(triangles.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    build(0, static_cast<Index>(order_.size()));
  }

  // Nearest triangle. Where several are equally near (a vertex or edge is nearest), the one that faces p most.
  Index nearest(const Vec3& p) const {
    Index best = -1;
    double distance2 = std::numeric_limits<double>::infinity(), facing = -1;
    search(0, p, best, distance2, facing);
    return best;
  }

 private:
  struct Node {
    Box box;
    Index first, count;  // triangles of a leaf; count = 0 inside
    Index right;         // the left child follows its parent
  };

  Index build(Index first, Index last) {
    const Index id = static_cast<Index>(nodes_.size());
    nodes_.push_back({Box(), first, 0, 0});
    Box box, middles;
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

  void search(Index id, const Vec3& p, Index& best, double& distance2, double& facing) const {
    const Node& node = nodes_[id];
    if (node.box.squaredExteriorDistance(p) > distance2 * (1 + 1e-9)) return;
    if (node.count == 0) {
      Index near = id + 1, far = node.right;
      if (nodes_[near].box.squaredExteriorDistance(p) > nodes_[far].box.squaredExteriorDistance(p)) std::swap(near, far);
      search(near, p, best, distance2, facing);
      search(far, p, best, distance2, facing);
      return;
    }
    for (Index i = node.first; i < node.first + node.count; ++i) {
      const Triangle& t = triangles_[order_[i]];
      const Vec3 &a = points_[t.v[0]], &b = points_[t.v[1]], &c = points_[t.v[2]];
      const Vec3 gap = p - closest(p, a, b, c), n = (b - a).cross(c - a).normalized();
      const double d2 = gap.squaredNorm(), f = std::abs(n.dot(gap));
      const double slack = 1e-9 * distance2 + 1e-300;
      const bool nearer = d2 < distance2 - slack, tie = !nearer && d2 <= distance2 + slack;
      if (nearer || best < 0 || (tie && (f > facing * (1 + 1e-9) || (f >= facing * (1 - 1e-9) && order_[i] < best)))) {
        best = order_[i];
        distance2 = std::min(distance2, d2);
        facing = f;
      }
    }
  }

  Vec3 middle(Index t) const { return (points_[triangles_[t].v[0]] + points_[triangles_[t].v[1]] + points_[triangles_[t].v[2]]) / 3; }

  const std::vector<Vec3>& points_;
  const std::vector<Triangle>& triangles_;
  std::vector<Index> order_;
  std::vector<Node> nodes_;
};

}  // namespace

Mapper::Mapper(const std::vector<Vec3>& rest_points, const std::vector<Triangle>& triangles, const std::vector<Vec3>& visual_points) {
  std::vector<Triangle> usable;  // slivers without a plane cannot carry a vertex
  for (const Triangle& t : triangles) {
    const Vec3 &a = rest_points[t.v[0]], &b = rest_points[t.v[1]], &c = rest_points[t.v[2]];
    const double longest2 = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    if ((b - a).cross(c - a).norm() > 1e-10 * longest2) usable.push_back(t);
  }
  if (usable.empty()) throw Error(Exit::scene, "a visual mesh needs a simulation surface to follow");
  const Tree tree(rest_points, usable);
  bindings_.reserve(visual_points.size());
  for (const Vec3& x : visual_points) {
    const Triangle& t = usable[tree.nearest(x)];
    const Vec3 &a = rest_points[t.v[0]], &b = rest_points[t.v[1]], &c = rest_points[t.v[2]];
    // x = a + u (b-a) + v (c-a) + offset n: three equations, three unknowns.
    const Vec3 cross = (b - a).cross(c - a), n = cross.normalized(), d = x - a;
    const double area2 = cross.squaredNorm();
    const double u = cross.dot(d.cross(c - a)) / area2, v = cross.dot((b - a).cross(d)) / area2;
    bindings_.push_back({t, {1 - u - v, u, v}, n.dot(d)});
  }
}

void Mapper::map(std::span<const Vec3> points, std::vector<Vec3>& visual_points) const {
  visual_points.resize(bindings_.size());
  for (std::size_t i = 0; i < bindings_.size(); ++i) {
    const Binding& k = bindings_[i];
    const Vec3 &a = points[k.triangle.v[0]], &b = points[k.triangle.v[1]], &c = points[k.triangle.v[2]];
    const Vec3 cross = (b - a).cross(c - a);
    const double length = cross.norm();
    visual_points[i] = k.weight[0] * a + k.weight[1] * b + k.weight[2] * c;
    if (length > 0) visual_points[i] += (k.offset / length) * cross;
  }
}

void Mapper::interpolate(std::span<const double> values, std::vector<double>& visual_values) const {
  visual_values.resize(bindings_.size());
  for (std::size_t i = 0; i < bindings_.size(); ++i) {
    // Weights cut to the triangle, so that a field keeps its range.
    double sum = 0, total = 0;
    for (int k = 0; k < 3; ++k) {
      const double w = std::max(0.0, bindings_[i].weight[k]);
      sum += w * values[bindings_[i].triangle.v[k]];
      total += w;
    }
    visual_values[i] = sum / total;
  }
}

}  // namespace mortise::visual
