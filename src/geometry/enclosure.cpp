#include "geometry/enclosure.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/collide/distance.h"
#include "geometry/solid_angle.h"

namespace mortise::geometry {

constexpr std::size_t kLeaf = 16;   // triangles
constexpr double kRounding = 1e-9;  // of the size of all

Enclosure::Enclosure(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) : points_(points) {
  boxes_.emplace_back();
  std::vector<Triangle> all = triangles;
  fill(0, all);
  rounding_ = kRounding * boxes_[0].bounds.size().norm();
}

// A fan over the edges that are left of these triangles.
static std::vector<Triangle> cap(const std::vector<Triangle>& of) {
  std::map<std::pair<Index, Index>, int> edges;  // how often more in this direction than in the other
  for (const Triangle& t : of)
    for (int k = 0; k < 3; ++k) {
      const Index a = t.v[k], b = t.v[(k + 1) % 3];
      edges[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  std::vector<Triangle> out;
  Index tip = -1;
  for (const auto& [edge, count] : edges) {
    if (count == 0) continue;
    if (tip < 0) tip = edge.first;
    if (edge.first == tip || edge.second == tip) continue;
    const Triangle one = count > 0 ? Triangle{{edge.first, edge.second, tip}} : Triangle{{edge.second, edge.first, tip}};
    for (int n = 0; n < std::abs(count); ++n) out.push_back(one);
  }
  return out;
}

void Enclosure::fill(int box, std::vector<Triangle>& of) {
  Bounds bounds;
  for (const Triangle& t : of)
    for (const Index v : t.v) bounds.include(points_[v]);
  boxes_[box].bounds = bounds;
  if (of.size() <= kLeaf) {
    boxes_[box].triangles = of;
    return;
  }
  boxes_[box].triangles = cap(of);
  Eigen::Index axis = 0;
  bounds.size().maxCoeff(&axis);
  const auto place = [&](const Triangle& t) { return points_[t.v[0]][axis] + points_[t.v[1]][axis] + points_[t.v[2]][axis]; };
  const auto middle = of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2);
  std::nth_element(of.begin(), middle, of.end(), [&](const Triangle& a, const Triangle& b) { return place(a) < place(b); });
  std::vector<Triangle> parts[] = {{of.begin(), middle}, {middle, of.end()}};
  const int first = boxes_[box].first = static_cast<int>(boxes_.size());
  boxes_.resize(boxes_.size() + 2);
  for (int k = 0; k < 2; ++k) fill(first + k, parts[k]);
}

static bool far(const Bounds& from, const Vec3& x, double room) { return (x - from.lo).minCoeff() < -room || (from.hi - x).minCoeff() < -room; }

bool Enclosure::add(int number, const Vec3& x, double room, double& angle) const {
  const Box& box = boxes_[number];
  const bool outside = far(box.bounds, x, room);
  if (!outside && box.first >= 0) return add(box.first, x, room, angle) && add(box.first + 1, x, room, angle);
  for (const Triangle& t : box.triangles) {
    const Vec3 p[4] = {x, points_[t.v[0]], points_[t.v[1]], points_[t.v[2]]};
    if (!outside && closest_point_triangle(p).squared <= room * room) return false;
    angle += solid_angle(p[1], p[2], p[3], x);
  }
  return true;
}

bool Enclosure::holds(const Vec3& x, double reach) const {
  const double room = reach + rounding_;
  double angle = 0;
  if (far(boxes_[0].bounds, x, room)) return false;
  return !add(0, x, room, angle) || angle > 2 * M_PI;
}

}  // namespace mortise::geometry
