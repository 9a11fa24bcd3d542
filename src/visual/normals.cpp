#include "visual/normals.h"

#include <array>
#include <cmath>
#include <map>
#include <numeric>

namespace mortise::visual {
namespace {

Vec3 cross_of(const std::vector<Vec3>& p, const Triangle& t) { return (p[t.v[1]] - p[t.v[0]]).cross(p[t.v[2]] - p[t.v[0]]); }

double angle_at(const std::vector<Vec3>& p, const Triangle& t, int k) {
  const Vec3 a = p[t.v[(k + 1) % 3]] - p[t.v[k]], b = p[t.v[(k + 2) % 3]] - p[t.v[k]];
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
  const double length = v.norm();
  return length > 0 ? Vec3(v / length) : otherwise;
}

}  // namespace

SmoothNormals::SmoothNormals(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, std::vector<Triangle> triangles)
    : triangles_(std::move(triangles)), group_(points.size()) {
  constexpr double same = 0.996;                           // cosine of 5 degrees
  std::map<std::array<double, 3>, std::vector<Index>> at;  // position -> first vertex of each group there
  std::vector<Index> leader_group(points.size());
  for (Index i = 0; i < static_cast<Index>(points.size()); ++i) {
    std::vector<Index>& leaders = at[{points[i][0], points[i][1], points[i][2]}];
    Index found = -1;
    for (const Index j : leaders)
      if (normals[i].dot(normals[j]) > same) found = leader_group[j];
    if (found < 0) {
      found = groups_++;
      leaders.push_back(i);
      leader_group[i] = found;
    }
    group_[i] = found;
  }
}

void SmoothNormals::compute(const std::vector<Vec3>& points, std::vector<Vec3>& normals) const {
  std::vector<Vec3> sum(static_cast<std::size_t>(groups_), Vec3::Zero());
  for (const Triangle& t : triangles_) {
    const Vec3 n = unit_or(cross_of(points, t), Vec3::Zero());
    for (int k = 0; k < 3; ++k) sum[group_[t.v[k]]] += angle_at(points, t, k) * n;
  }
  normals.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) normals[i] = unit_or(sum[group_[i]], Vec3::UnitZ());
}

SplitSurface split_creases(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles, double crease) {
  const double limit = std::cos(crease);
  std::vector<Vec3> face;
  for (const Triangle& t : triangles) face.push_back(unit_or(cross_of(points, t), Vec3::Zero()));

  // Corners at a point belong together when a chain of triangles around it joins them without a sharp edge.
  const auto corner = [](std::size_t t, int k) { return static_cast<Index>(3 * t) + k; };
  std::vector<Index> parent(3 * triangles.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](Index i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  std::map<std::array<Index, 2>, std::array<Index, 3>> edges;  // (low, high) -> triangle, its corners at low and high
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      int a = k, b = (k + 1) % 3;
      if (triangles[t].v[a] > triangles[t].v[b]) std::swap(a, b);
      const auto [it, fresh] =
          edges.try_emplace({triangles[t].v[a], triangles[t].v[b]}, std::array<Index, 3>{static_cast<Index>(t), corner(t, a), corner(t, b)});
      if (fresh || face[it->second[0]].dot(face[t]) < limit) continue;
      parent[root(corner(t, a))] = root(it->second[1]);
      parent[root(corner(t, b))] = root(it->second[2]);
    }

  SplitSurface out;
  std::vector<Index> vertex(parent.size(), -1);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    Triangle split{};
    for (int k = 0; k < 3; ++k) {
      Index& v = vertex[root(corner(t, k))];
      if (v < 0) {
        v = static_cast<Index>(out.source.size());
        out.source.push_back(triangles[t].v[k]);
        out.normals.push_back(Vec3::Zero());
      }
      split.v[k] = v;
      out.normals[v] += angle_at(points, triangles[t], k) * face[t];
    }
    out.triangles.push_back(split);
  }
  for (Vec3& n : out.normals) n = unit_or(n, Vec3::UnitZ());
  return out;
}

}  // namespace mortise::visual
