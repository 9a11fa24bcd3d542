// Pressure of points from the forces on them (effects/contact/nodal_pressure.h).
#include "effects/contact/nodal_pressure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

#include "geometry/primitives.h"
#include "geometry/topology.h"

namespace mortise {
namespace {

using effects::contact::nodal_pressure;

geometry::Surface surface_of(const std::vector<Triangle>& triangles) {
  geometry::Surface out;
  out.triangles.upload(triangles);
  return out;
}

// Forces of a uniform pressure on some of the triangles.
std::vector<double> pressed(const std::vector<Vec3>& y, const std::vector<Triangle>& triangles, double p) {
  std::vector<double> f(3 * y.size(), 0.0);
  for (const Triangle& t : triangles) {
    const Vec3 third = -p / 6 * (y[t.v[1]] - y[t.v[0]]).cross(y[t.v[2]] - y[t.v[0]]);
    for (Index i : t.v) Eigen::Map<Vec3>(f.data() + 3 * i) += third;
  }
  return f;
}

std::vector<Triangle> those(const std::vector<Triangle>& triangles, const std::function<bool(const Triangle&)>& takes) {
  std::vector<Triangle> out;
  std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(out), takes);
  return out;
}

double sum_of(const std::vector<Vec3>& y, const std::vector<Triangle>& on, const std::vector<double>& p) {
  const std::vector<double> area = geometry::vertex_areas(y, on);
  double sum = 0;
  for (std::size_t i = 0; i < y.size(); ++i) sum += p[i] * area[i];
  return sum;
}

struct Block {
  geometry::TetMesh mesh = geometry::box({1, 1, 1}, std::array<Index, 3>{4, 4, 4});
  std::vector<Triangle> triangles = geometry::boundary_triangles(mesh);
  double end(int axis, int sign) const {
    double out = -INFINITY;
    for (const Vec3& x : mesh.points) out = std::max(out, sign * x[axis]);
    return sign * out;
  }
  std::vector<Triangle> side(int axis, int sign) const {
    return those(triangles, [&](const Triangle& t) {
      return std::all_of(t.v, t.v + 3, [&](Index i) { return std::abs(mesh.points[i][axis] - end(axis, sign)) < 1e-12; });
    });
  }
};

// The sides of a block bulge and are no part of what is pressed; also where it is turned.
TEST(NodalPressure, OfAPressedSideIsThatPressureUpToItsRim) {
  Block b;
  const double top = b.end(2, 1);
  const std::vector<Triangle> on = b.side(2, 1);
  ASSERT_EQ(on.size(), 32u);
  for (Vec3& x : b.mesh.points) x.head<2>() *= 1 + 0.2 * (top - x[2]);
  const Mat3 R = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (Vec3& x : b.mesh.points) x = R * x;
  const std::vector<double> p = nodal_pressure(surface_of(b.triangles), b.mesh.points, pressed(b.mesh.points, on, 300)).pressure;
  const std::vector<double> area = geometry::vertex_areas(b.mesh.points, on);
  for (std::size_t i = 0; i < p.size(); ++i) EXPECT_NEAR(p[i], area[i] > 0 ? 300 : 0, 1e-10);
}

// Both sides of a ridge are pressed: their forces partly cancel, and so do their areas.
TEST(NodalPressure, OfBothSidesOfARidge) {
  const Block b;
  std::vector<Triangle> on = b.side(2, 1);
  const std::vector<Triangle> beside = b.side(0, -1);
  on.insert(on.end(), beside.begin(), beside.end());
  const std::vector<double> p = nodal_pressure(surface_of(b.triangles), b.mesh.points, pressed(b.mesh.points, on, 300)).pressure;
  const std::vector<double> area = geometry::vertex_areas(b.mesh.points, on);
  for (std::size_t i = 0; i < p.size(); ++i) EXPECT_NEAR(p[i], area[i] > 0 ? 300 : 0, 1e-10);
}

// However the force is spread over a side, pressures times areas add up to it. That is what a mean over the part in contact does not.
TEST(NodalPressure, AddsUpToTheForce) {
  const Block b;
  const std::vector<Triangle> on = b.side(2, 1);
  const std::vector<double> area = geometry::vertex_areas(b.mesh.points, on);
  std::vector<double> f(3 * b.mesh.points.size(), 0.0);
  std::mt19937 random(7);
  double sum = 0;
  for (std::size_t i = 0; i < area.size(); ++i)
    if (area[i] > 0 && random() % 3 == 0) sum += -(f[3 * i + 2] = -std::uniform_real_distribution<>(0, 1)(random));
  ASSERT_GT(sum, 0);
  EXPECT_NEAR(sum_of(b.mesh.points, on, nodal_pressure(surface_of(b.triangles), b.mesh.points, f).pressure), sum, 1e-13);
}

}  // namespace
}  // namespace mortise
