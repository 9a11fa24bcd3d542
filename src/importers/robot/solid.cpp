#include "importers/robot/solid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/bounds.h"
#include "geometry/collide/distance.h"
#include "geometry/primitives.h"
#include "geometry/solid_angle.h"
#include "geometry/topology.h"
#include "importers/robot/tuning.h"

namespace mortise::importers {
namespace {

using geometry::Bounds;

struct Corners {
  Vec3 v[3];
  Bounds box;
  explicit Corners(const geometry::TriMesh& m, const Triangle& t) : v{m.points[t.v[0]], m.points[t.v[1]], m.points[t.v[2]]} {
    for (const Vec3& x : v) box.include(x);
  }
};

bool far(const Bounds& a, const Bounds& b, double distance) { return (a.lo - b.hi).maxCoeff() > distance || (b.lo - a.hi).maxCoeff() > distance; }

bool crosses(const Vec3& p, const Vec3& q, const Vec3 t[3]) {
  const auto volume = [](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) { return (b - a).cross(c - a).dot(d - a); };
  if (volume(t[0], t[1], t[2], p) * volume(t[0], t[1], t[2], q) > 0) return false;
  const double s0 = volume(p, q, t[0], t[1]), s1 = volume(p, q, t[1], t[2]), s2 = volume(p, q, t[2], t[0]);
  return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}

bool near(const Corners& a, const Corners& b, double distance) {
  const double squared = distance * distance;
  for (int i = 0; i < 3; ++i) {
    const Vec3 pb[4] = {a.v[i], b.v[0], b.v[1], b.v[2]}, pa[4] = {b.v[i], a.v[0], a.v[1], a.v[2]};
    if (geometry::closest_point_triangle(pb).squared <= squared || geometry::closest_point_triangle(pa).squared <= squared) return true;
    if (crosses(a.v[i], a.v[(i + 1) % 3], b.v) || crosses(b.v[i], b.v[(i + 1) % 3], a.v)) return true;
    for (int j = 0; j < 3; ++j) {
      const Vec3 e[4] = {a.v[i], a.v[(i + 1) % 3], b.v[j], b.v[(j + 1) % 3]};
      if (geometry::closest_edge_edge(e).squared <= squared) return true;
    }
  }
  return false;
}

// How often a closed surface winds around x.
double winding(const std::vector<Corners>& surface, const Vec3& x) {
  double angle = 0;
  for (const Corners& t : surface) angle += geometry::solid_angle(t.v[0], t.v[1], t.v[2], x);
  return angle / (4 * std::numbers::pi);
}

}  // namespace

double edge_length(const Shape& s) {
  switch (s.kind) {
    case Shape::Kind::box:
      return s.size.maxCoeff();
    case Shape::Kind::sphere:
      return kBallCells * s.radius;
    case Shape::Kind::cylinder:
    case Shape::Kind::capsule:
      return kRoundCells * s.radius;
    case Shape::Kind::ellipsoid:
      return kBallCells * 0.5;
    case Shape::Kind::mesh:
      break;
  }
  return 0;
}

geometry::TriMesh surface(const Shape& s, const Pose& at) {
  const double h = edge_length(s);
  geometry::TriMesh out;
  switch (s.kind) {
    case Shape::Kind::box:
      out = geometry::skin(geometry::box_grid(s.size, h));
      break;
    case Shape::Kind::sphere:
      out = geometry::skin(geometry::sphere_grid(s.radius, h));
      break;
    case Shape::Kind::cylinder:
      out = geometry::skin(geometry::cylinder_grid(s.radius, s.length, h));
      break;
    case Shape::Kind::capsule:
      out = geometry::skin(geometry::capsule_grid(s.radius, s.length, h));
      break;
    case Shape::Kind::ellipsoid:
      out = geometry::skin(geometry::sphere_grid(0.5, h));
      for (Vec3& x : out.points) x = x.cwiseProduct(s.size);
      break;
    case Shape::Kind::mesh:
      out = *s.surface;
      for (Vec3& x : out.points) x = x.cwiseProduct(s.scale);
      break;
  }
  for (Vec3& x : out.points) x = at(x);
  return out;
}

bool meet(const geometry::TriMesh& a, const geometry::TriMesh& b, double distance) {
  const Bounds around_a = geometry::bounds_of(a.points), around_b = geometry::bounds_of(b.points);
  if (a.points.empty() || b.points.empty() || far(around_a, around_b, distance)) return false;
  std::vector<Corners> of_a, of_b;
  for (const Triangle& t : a.triangles) of_a.emplace_back(a, t);
  for (const Triangle& t : b.triangles) of_b.emplace_back(b, t);
  for (const Corners& s : of_a) {
    if (far(s.box, around_b, distance)) continue;
    for (const Corners& t : of_b)
      if (!far(s.box, t.box, distance) && near(s, t, distance)) return true;
  }
  return std::abs(winding(of_a, b.points[0])) > 0.5 || std::abs(winding(of_b, a.points[0])) > 0.5;
}

std::pair<Vec3, Vec3> bounds(const Shape& s, const Pose& at) {
  if (s.kind == Shape::Kind::mesh) {
    const geometry::Bounds b = geometry::bounds_of(surface(s, at).points);
    return {b.lo, b.hi};
  }
  Vec3 half = Vec3::Constant(s.radius);
  if (s.kind == Shape::Kind::ellipsoid) half = 0.5 * (at.R * s.size.asDiagonal()).rowwise().norm();
  if (s.kind == Shape::Kind::box) half = 0.5 * (at.R.cwiseAbs() * s.size);
  if (s.kind == Shape::Kind::capsule) half += 0.5 * s.length * at.R.col(2).cwiseAbs();
  if (s.kind == Shape::Kind::cylinder)  // a disc of normal n reaches r sqrt(1 - n_i^2) along axis i
    for (int i = 0; i < 3; ++i) half[i] = 0.5 * s.length * std::abs(at.R(i, 2)) + s.radius * std::sqrt(std::max(0.0, 1 - at.R(i, 2) * at.R(i, 2)));
  return {at.t - half, at.t + half};
}

}  // namespace mortise::importers
