#include "importers/robot/weigh.h"

#include <cmath>
#include <numbers>

#include "geometry/hull.h"
#include "geometry/topology.h"
#include "importers/robot/inertial.h"
#include "importers/robot/solid.h"

namespace mortise::importers {
namespace {

using geometry::MassProperties;

MassProperties solid(const Shape& mesh) {
  geometry::TriMesh polyhedron = surface(mesh, Pose{});
  MassProperties out = geometry::mass_properties(polyhedron);
  if (out.volume > 0) return out;
  try {
    return geometry::mass_properties(geometry::convex_hull(polyhedron.points));
  } catch (const Error&) {  // a picture on a plane: it has no volume
    MassProperties flat;
    for (const Vec3& x : polyhedron.points) flat.centroid += x / static_cast<double>(polyhedron.points.size());
    return flat;
  }
}

// int X X^T dV / V about the middle: half the differences of the moments, without (0.5 tr I - I_i).
Vec3 spread(const Shape& s) {
  const double r2 = s.radius * s.radius, l2 = s.length * s.length;
  switch (s.kind) {
    case Shape::Kind::box:
      return s.size.cwiseAbs2() / 12;
    case Shape::Kind::ellipsoid:
      return s.size.cwiseAbs2() / 20;
    case Shape::Kind::sphere:
      return Vec3::Constant(r2 / 5);
    case Shape::Kind::cylinder:
      return {r2 / 4, r2 / 4, l2 / 12};
    case Shape::Kind::capsule: {  // a cylinder of volume share c, and two half balls whose flat sides are l / 2 from the middle
      const double c = s.length / (s.length + s.radius * 4 / 3), across = c * r2 / 4 + (1 - c) * r2 / 5;
      return {across, across, c * l2 / 12 + (1 - c) * (r2 / 5 + s.length * s.radius * 3 / 8 + l2 / 4)};
    }
    case Shape::Kind::mesh:
      break;
  }
  return Vec3::Zero();
}

}  // namespace

double volume(const Shape& s) {
  const double disc = std::numbers::pi * s.radius * s.radius;
  switch (s.kind) {
    case Shape::Kind::box:
      return s.size.prod();
    case Shape::Kind::ellipsoid:
      return std::numbers::pi / 6 * s.size.prod();
    case Shape::Kind::sphere:
      return disc * s.radius * 4 / 3;
    case Shape::Kind::cylinder:
      return disc * s.length;
    case Shape::Kind::capsule:
      return disc * (s.length + s.radius * 4 / 3);
    case Shape::Kind::mesh:
      break;
  }
  return solid(s).volume;
}

Inertial inertial_of(const Shape& s, double mass) {
  Inertial out;
  out.mass = mass, out.where = s.where;
  Mat3 X = spread(s).asDiagonal();
  if (s.kind == Shape::Kind::mesh) {
    const MassProperties m = solid(s);
    out.centre = m.centroid, X = m.volume > 0 ? Mat3(m.second_moment / m.volume) : Mat3(Mat3::Zero());
  }
  out.tensor = mass * (X.trace() * Mat3::Identity() - X);
  return moved(out, s.at);
}

void weigh(Robot& robot) {
  for (Link& link : robot.links) {
    if (link.inertial && !link.weighed) continue;
    Inertial sum;
    for (std::vector<Shape>* shapes : {&link.collisions, &link.visuals})
      for (Shape& s : *shapes) {
        if (!s.mass && !s.density) continue;
        if (s.kind == Shape::Kind::mesh && s.mass.value_or(1) * s.density.value_or(1) != 0) robot.read_surface(s);
        const double mass = s.mass ? *s.mass : *s.density == 0 ? 0 : *s.density * volume(s);
        if (mass > 0) sum = together(sum, inertial_of(s, mass));
      }
    if (sum.mass > 0) link.inertial = sum;
  }
}

}  // namespace mortise::importers
