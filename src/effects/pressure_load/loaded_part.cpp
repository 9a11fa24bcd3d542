#include "effects/pressure_load/loaded_part.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "base/disjoint_sets.h"
#include "geometry/cut_polygon.h"

namespace mortise::effects::pressure_load {
namespace {

// Cosine of the angle between the normals of neighbours that are of one face: the 0.7 rad at which meshing keeps an edge sharp.
const double kSameFace = std::cos(0.7);

// Of a triangle's extent across a box's side: a corner that is closer to it lies on it. Boxes are drawn a little wider than what they hold, or end on
// lines of the mesh but for rounding.
constexpr double kOnSide = 0.01;
constexpr double kNothing = 1e-9, kWhole = 1 - kNothing;  // of a triangle's area

constexpr double kMeant = 0.5;  // of the largest part, where none holds a whole triangle: others are rims of walls beside it

// Chords that stand for the arc of a circle that is seen from its middle within a triangle.
constexpr int kChords = 64;

// Without what lies where the linear function with the values d at the triangle's corners is negative.
Polygon cut(const Polygon& polygon, const Vec3& d) {
  return geometry::cut(polygon, [&d](const Vec3& b) { return d.dot(b); });
}

Vec3 on_side(const Vec3& d) {
  const double near = kOnSide * (d.maxCoeff() - d.minCoeff());
  return d.unaryExpr([near](double v) { return std::abs(v) <= near ? 0.0 : v; });
}

// Angles [rad] under which a triangle of the plane is seen from the origin: all of them, where that is inside.
std::pair<double, double> seen(const std::array<Eigen::Vector2d, 3>& x) {
  const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a[0] * b[1] - a[1] * b[0]; };
  if (cross(x[0], x[1]) >= 0 && cross(x[1], x[2]) >= 0 && cross(x[2], x[0]) >= 0) return {-std::numbers::pi, std::numbers::pi};
  const Eigen::Vector2d middle = (x[0] + x[1] + x[2]) / 3;
  double least = 0, most = 0;
  for (const Eigen::Vector2d& p : x) {
    const double from_middle = std::atan2(cross(middle, p), middle.dot(p));
    least = std::min(least, from_middle), most = std::max(most, from_middle);
  }
  const double at = std::atan2(middle[1], middle[0]);
  return {at + least, at + most};
}

// The plane of the triangle cuts the ball in a circle of radius rho, which is where  rho e(a) . y <= rho^2  for all angles a; chords in their place
// have the circle's area.
Polygon inside_ball(const std::array<Vec3, 3>& x, const Vec3& centre, double radius) {
  const Vec3 n = (x[1] - x[0]).cross(x[2] - x[0]).normalized(), u = (x[1] - x[0]).normalized(), v = n.cross(u);
  const double off = n.dot(x[0] - centre);
  if (!(off < radius && off > -radius)) return {};
  std::array<Eigen::Vector2d, 3> y;
  for (int k = 0; k < 3; ++k) y[k] = {u.dot(x[k] - centre), v.dot(x[k] - centre)};
  const auto [from, to] = seen(y);
  const double half = (to - from) / (2 * kChords);
  // The distance a of a chord that cuts off a triangle of the sector's area: a^2 tan(half) = rho^2 half.
  const double distance = std::sqrt((radius - off) * (radius + off) * (half > 0 ? half / std::tan(half) : 1));
  Polygon part = whole_triangle;
  for (int i = 0; i < kChords && !part.empty(); ++i) {
    const double angle = from + (2 * i + 1) * half;
    const Eigen::Vector2d e(std::cos(angle), std::sin(angle));
    part = cut(part, Vec3(distance - e.dot(y[0]), distance - e.dot(y[1]), distance - e.dot(y[2])));
  }
  return part;
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
      part = cut(cut(part, on_side(along - Vec3::Constant(lo[a]))), on_side(Vec3::Constant(hi[a]) - along));
    }
    return part;
  }
  return inside_ball(x, where.at("sphere").vec3("centre"), where.at("sphere").number("radius"));
}

std::vector<Polygon> loaded_parts(const model::Model& model, const model::Body& body, std::span<const Triangle> triangles,
                                  std::span<const Vec3> points, const Params& where) {
  std::vector<Polygon> out(triangles.size());
  const auto corners = [&](std::size_t t) {
    const Index* v = triangles[t].v;
    return std::array{points[v[0]], points[v[1]], points[v[2]]};
  };
  if (where.has("side")) {
    std::vector<bool> selected(points.size(), false);
    for (const Index point : model::select_points(model, body, where)) selected[point] = true;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const Index* v = triangles[t].v;
      if (selected[v[0]] && selected[v[1]] && selected[v[2]]) out[t] = whole_triangle;
    }
    return out;
  }
  struct Connected {
    double area = 0;  // [m^2]
    bool whole = false;
  };
  const std::size_t n = triangles.size();
  std::vector<Polygon> inside(n);
  std::vector<Vec3> twice(n);  // the triangle's area, times its normal
  std::vector<Share> share(n);
  for (std::size_t t = 0; t < n; ++t) {
    const std::array<Vec3, 3> x = corners(t);
    twice[t] = (x[1] - x[0]).cross(x[2] - x[0]);
    inside[t] = part_inside(x, where), share[t] = share_of(inside[t]);
    if (share[t].area <= kNothing) inside[t].clear();
  }
  DisjointSets faces(n);
  const std::vector<std::array<Index, 3>> neighbours = neighbours_of(triangles);
  for (std::size_t t = 0; t < n; ++t)
    for (const Index next : neighbours[t])
      if (next >= 0 && !inside[t].empty() && !inside[next].empty() && twice[t].normalized().dot(twice[next].normalized()) >= kSameFace)
        faces.join(t, static_cast<std::size_t>(next));
  std::map<std::size_t, Connected> connected;
  for (std::size_t t = 0; t < n; ++t) {
    Connected& of = connected[faces.of(t)];
    of.area += share[t].area * twice[t].norm() / 2, of.whole = of.whole || share[t].area >= kWhole;
  }
  bool whole = false;
  double largest = 0;
  for (const auto& [name, of] : connected) whole = whole || of.whole, largest = std::max(largest, of.area);
  for (std::size_t t = 0; t < n; ++t) {
    const Connected& of = connected.at(faces.of(t));
    if (whole ? of.whole : of.area >= kMeant * largest) out[t] = inside[t];
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
