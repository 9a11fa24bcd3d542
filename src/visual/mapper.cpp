#include "visual/mapper.h"

#include <algorithm>
#include <array>

#include "base/error.h"
#include "geometry/nearest_triangle.h"

namespace mortise::visual {
Mapper::Mapper(const std::vector<Vec3>& rest_points, const std::vector<Triangle>& triangles, const std::vector<Vec3>& visual_points) {
  std::vector<Triangle> usable;  // slivers without a plane cannot carry a vertex
  for (const Triangle& t : triangles) {
    const Vec3 &a = rest_points[t.v[0]], &b = rest_points[t.v[1]], &c = rest_points[t.v[2]];
    const double longest2 = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    if ((b - a).cross(c - a).norm() > 1e-10 * longest2) usable.push_back(t);
  }
  if (usable.empty()) throw Error(Exit::scene, "a visual mesh needs a simulation surface to follow");
  const geometry::NearestTriangle tree(rest_points, usable);
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
