#include "effects/pressure_load/loaded_part.h"

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace mortise::effects::pressure_load {
namespace {

// Cosine of the angle between the normals of neighbours that are of one face: the 0.7 rad at which meshing keeps an edge sharp.
const double kSameFace = std::cos(0.7);

// Sides of the polygon that stands for a circle: its farthest corner is 2e-4 of the radius outside.
constexpr int kCircle = 64;

// Without what lies where the linear function with the values d at the triangle's corners is negative (Sutherland and Hodgman 1974).
Polygon cut(const Polygon& polygon, const Vec3& d) {
  Polygon out;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double da = d.dot(a), db = d.dot(b);
    if (da >= 0) out.push_back(a);
    if ((da < 0) != (db < 0)) out.push_back(a + da / (da - db) * (b - a));
  }
  return out;
}

// Triangles across the edges of each, -1 where there is none.
std::vector<std::array<Index, 3>> neighbours_of(std::span<const Triangle> triangles) {
  std::vector<std::array<Index, 3>> out(triangles.size(), {-1, -1, -1});
  std::map<std::pair<Index, Index>, std::pair<Index, int>> open;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Index a = triangles[t].v[k], b = triangles[t].v[(k + 1) % 3];
      const auto other = open.find({b, a});
      if (other == open.end()) {
        open[{a, b}] = {static_cast<Index>(t), k};
        continue;
      }
      out[t][k] = other->second.first;
      out[other->second.first][other->second.second] = static_cast<Index>(t);
    }
  return out;
}

}  // namespace

Polygon part_inside(const std::array<Vec3, 3>& x, const Params& where) {
  Polygon part = whole_triangle;
  if (where.has("box")) {
    const Vec3 lo = where.at("box").vec3("min"), hi = where.at("box").vec3("max");
    for (int a = 0; a < 3; ++a) {
      const Vec3 along(x[0][a], x[1][a], x[2][a]);
      part = cut(cut(part, along - Vec3::Constant(lo[a])), Vec3::Constant(hi[a]) - along);
    }
    return part;
  }
  const Vec3 centre = where.at("sphere").vec3("centre");
  const double radius = where.at("sphere").number("radius");
  const Vec3 n = (x[1] - x[0]).cross(x[2] - x[0]).normalized(), u = (x[1] - x[0]).normalized(), v = n.cross(u);
  const double off = n.dot(x[0] - centre);
  if (!(off < radius && off > -radius)) return {};
  // The inner radius a of a polygon of n sides with the circle's area: n a^2 tan(pi / n) = pi r^2.
  const double side = std::numbers::pi / kCircle;
  const double inner = std::sqrt((radius * radius - off * off) * side / std::tan(side));
  for (int i = 0; i < kCircle && !part.empty(); ++i) {
    const Vec3 out = std::cos(2 * side * i) * u + std::sin(2 * side * i) * v;
    part = cut(part, Vec3(inner - out.dot(x[0] - centre), inner - out.dot(x[1] - centre), inner - out.dot(x[2] - centre)));
  }
  return part;
}

std::vector<Polygon> loaded_parts(std::span<const Triangle> triangles, std::span<const Vec3> points, const std::vector<bool>& selected,
                                  const Params& where) {
  std::vector<Polygon> out(triangles.size());
  std::vector<std::size_t> grown;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Index* v = triangles[t].v;
    if (selected[v[0]] && selected[v[1]] && selected[v[2]]) out[t] = whole_triangle, grown.push_back(t);
  }
  if (where.has("side")) return out;
  const auto normal = [&](std::size_t t) {
    const Index* v = triangles[t].v;
    return (points[v[1]] - points[v[0]]).cross(points[v[2]] - points[v[0]]).normalized();
  };
  const std::vector<std::array<Index, 3>> neighbours = neighbours_of(triangles);
  for (std::size_t done = 0; done < grown.size(); ++done)
    for (const Index next : neighbours[grown[done]]) {
      if (next < 0 || !out[next].empty() || normal(grown[done]).dot(normal(next)) < kSameFace) continue;
      const Index* v = triangles[next].v;
      out[next] = part_inside({points[v[0]], points[v[1]], points[v[2]]}, where);
      if (!out[next].empty()) grown.push_back(static_cast<std::size_t>(next));
    }
  return out;
}

Share share_of(const Polygon& polygon) {
  Share out;
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    // Barycentrics are affine in the place: the share is the determinant of the three corners.
    const double area = polygon[0].dot(polygon[i - 1].cross(polygon[i]));
    out.area += area;
    out.mean += area / 3 * (polygon[0] + polygon[i - 1] + polygon[i]);
  }
  if (out.area > 0) out.mean /= out.area;
  return out;
}

}  // namespace mortise::effects::pressure_load
