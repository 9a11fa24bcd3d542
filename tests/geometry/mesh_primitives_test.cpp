#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "base/error.h"
#include "geometry/primitives.h"
#include "geometry/topology.h"

namespace mortise::geometry {
namespace {

constexpr double kDegree = M_PI / 180;

double smallest_tet(const TetMesh& m) {
  double v = 1e300;
  for (const Tet& t : m.tets) v = std::min(v, tet_volume(m.points, t));
  return v;
}

int euler_characteristic(const TriMesh& s) {
  return static_cast<int>(s.points.size()) - static_cast<int>(unique_edges(s.triangles).size()) +
         static_cast<int>(s.triangles.size());
}

// Each directed edge once and its reverse once: closed, manifold along edges, consistently oriented.
void expect_closed(const TriMesh& s) {
  std::map<std::pair<Index, Index>, int> count;
  for (const Triangle& t : s.triangles)
    for (int k = 0; k < 3; ++k) ++count[{t.v[k], t.v[(k + 1) % 3]}];
  for (const auto& [e, n] : count) {
    ASSERT_EQ(n, 1);
    ASSERT_TRUE(count.contains({e.second, e.first}));
  }
}

void expect_sound(const TetMesh& m, double min_angle) {
  EXPECT_GT(smallest_tet(m), 0);
  EXPECT_GT(min_dihedral_angle(m), min_angle);
  const TriMesh s = surface_of(m);
  expect_closed(s);
  EXPECT_EQ(euler_characteristic(s), 2);
  EXPECT_EQ(component_count(connected_components(s)), 1);
  EXPECT_NEAR(mass_properties(s).volume, volume(m), 1e-12 * volume(m));
}

TEST(Primitives, BoxFillsItsBounds) {
  const TetMesh m = box({0.02, 0.02, 0.004}, 0.0008);
  EXPECT_EQ(m.points.size(), 26u * 26 * 6);
  EXPECT_EQ(m.tets.size(), 25u * 25 * 5 * 6);
  expect_sound(m, 44.9 * kDegree);
  EXPECT_NEAR(volume(m), 1.6e-6, 1e-12 * 1.6e-6);
  EXPECT_NEAR(area(surface_of(m)), 2 * 4e-4 + 4 * 8e-5, 1e-15);
  Vec3 lo = m.points[0], hi = lo;
  for (const Vec3& p : m.points) lo = lo.cwiseMin(p), hi = hi.cwiseMax(p);
  EXPECT_EQ(lo, Vec3(-0.01, -0.01, -0.002));
  EXPECT_EQ(hi, Vec3(0.01, 0.01, 0.002));
}

TEST(Primitives, BoxFaceVerticesCarryEqualAreas) {
  const TetMesh m = box({1, 1, 1}, std::array<Index, 3>{4, 4, 4});
  const std::vector<double> w = vertex_areas(m.points, boundary_triangles(m));
  double sum = 0;
  for (std::size_t i = 0; i < w.size(); ++i) {
    const Vec3& p = m.points[i];
    int on = 0;
    for (int a = 0; a < 3; ++a) on += std::abs(p[a]) == 0.5;
    if (on == 0) {
      EXPECT_EQ(w[i], 0);
    }
    if (on == 1) {
      EXPECT_NEAR(w[i], 1.0 / 16, 1e-15);
    }
    sum += w[i];
  }
  EXPECT_NEAR(sum, 6, 1e-13);
}

TEST(Primitives, RefuseNonsense) {
  EXPECT_THROW(box({1, 0, 1}, 0.1), Error);
  EXPECT_THROW(sphere(-1, 0.1), Error);
  EXPECT_THROW(cylinder(1, 1, 0), Error);
  EXPECT_THROW(sphere(1, 1e-9), Error);
  EXPECT_THROW(box({1, 1, 1}, 1e-3), Error);
}

// Error of the volume falls with the square of the edge length.
template <class Make>
void expect_second_order(const Make& make, double exact) {
  const double e1 = exact - volume(make(0.25)), e2 = exact - volume(make(0.125));
  EXPECT_GT(e1, 0) << "an inscribed body is smaller";
  EXPECT_LT(e1, 0.1 * exact);
  EXPECT_NEAR(std::log2(e1 / e2), 2, 0.1);
}

TEST(Primitives, Sphere) {
  for (double h : {1.0, 0.5, 0.25, 0.125}) {
    const TetMesh m = sphere(1, h);
    expect_sound(m, 20 * kDegree);
    for (const Vec3& p : surface_of(m).points) ASSERT_NEAR(p.norm(), 1, 4e-16);
  }
  expect_second_order([](double h) { return sphere(1, h); }, 4.0 / 3 * M_PI);
}

TEST(Primitives, Cylinder) {
  for (double h : {1.0, 0.5, 0.25, 0.125}) {
    const TetMesh m = cylinder(1, 1.7, h);
    expect_sound(m, 20 * kDegree);
    for (const Vec3& p : surface_of(m).points) {
      const bool cap = std::abs(std::abs(p[2]) - 0.85) < 1e-15;
      ASSERT_TRUE(cap || std::abs(p.head<2>().norm() - 1) < 4e-16);
    }
  }
  expect_second_order([](double h) { return cylinder(1, 1.5, h); }, 1.5 * M_PI);
}

TEST(Primitives, Capsule) {
  for (double h : {1.0, 0.5, 0.25, 0.125}) {
    const TetMesh m = capsule(1, 1.7, h);
    expect_sound(m, 20 * kDegree);
    for (const Vec3& p : surface_of(m).points) {
      const double to_spine = (p - Vec3(0, 0, std::clamp(p[2], -0.85, 0.85))).norm();
      ASSERT_NEAR(to_spine, 1, 4e-16);
    }
  }
  expect_second_order([](double h) { return capsule(1, 1.5, h); }, (1.5 + 4.0 / 3) * M_PI);
}

TEST(Primitives, SphereIsMirrorSymmetric) {
  const TetMesh m = sphere(1, 0.25);
  for (int axis = 0; axis < 3; ++axis) {
    std::map<std::array<double, 3>, int> seen;
    for (const Vec3& p : m.points) ++seen[{p[0], p[1], p[2]}];
    for (Vec3 p : m.points) {
      p[axis] = -p[axis] + 0.0;
      ASSERT_TRUE(seen.contains({p[0], p[1], p[2]}));
    }
  }
}

TEST(Primitives, Deterministic) {
  const TetMesh a = capsule(0.3, 0.4, 0.1), b = capsule(0.3, 0.4, 0.1);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) ASSERT_EQ(a.points[i], b.points[i]);
}

}  // namespace
}  // namespace mortise::geometry
