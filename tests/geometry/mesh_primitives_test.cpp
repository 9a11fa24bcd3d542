#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

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
  return static_cast<int>(s.points.size()) - static_cast<int>(unique_edges(s.triangles).size()) + static_cast<int>(s.triangles.size());
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
  EXPECT_EQ(m.points.size(), 27u * 27 * 7) << "25 x 25 x 5 edges: the next even numbers";
  EXPECT_EQ(m.tets.size(), 26u * 26 * 6 * 6);
  expect_sound(m, 40 * kDegree);
  EXPECT_NEAR(volume(m), 1.6e-6, 1e-12 * 1.6e-6);
  EXPECT_NEAR(area(surface_of(m)), 2 * 4e-4 + 4 * 8e-5, 1e-15);
  Vec3 lo = m.points[0], hi = lo;
  for (const Vec3& p : m.points) lo = lo.cwiseMin(p), hi = hi.cwiseMax(p);
  EXPECT_EQ(lo, Vec3(-0.01, -0.01, -0.002));
  EXPECT_EQ(hi, Vec3(0.01, 0.01, 0.002));
}

// In the middle of a face four or eight triangles meet, in turns.
TEST(Primitives, BoxFaceVerticesShareTheArea) {
  const TetMesh m = box({1, 1, 1}, std::array<Index, 3>{4, 4, 4});
  const std::vector<double> w = vertex_areas(m.points, boundary_triangles(m));
  double sum = 0;
  for (std::size_t i = 0; i < w.size(); ++i) {
    const Vec3 p = 4 * m.points[i];
    int on = 0, odd = 0;
    for (int a = 0; a < 3; ++a) on += std::abs(p[a]) == 2, odd += std::abs(p[a]) == 1;
    if (on == 0) {
      EXPECT_EQ(w[i], 0);
    }
    if (on == 1) {
      EXPECT_NEAR(w[i], (odd == 1 ? 1 : 2) / 24.0, 1e-15);
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

// Tetrahedra whose mirror image about the middle plane of `axis` is no tetrahedron of the mesh.
std::vector<Tet> without_image(const TetMesh& m, int axis) {
  std::map<std::array<double, 3>, Index> at;
  for (std::size_t i = 0; i < m.points.size(); ++i) at[{m.points[i][0], m.points[i][1], m.points[i][2]}] = static_cast<Index>(i);
  std::set<std::array<Index, 4>> tets;
  for (const Tet& t : m.tets) {
    std::array<Index, 4> v{t.v[0], t.v[1], t.v[2], t.v[3]};
    std::sort(v.begin(), v.end());
    tets.insert(v);
  }
  std::vector<Tet> out;
  for (const Tet& t : m.tets) {
    std::array<Index, 4> v;
    for (int k = 0; k < 4; ++k) {
      Vec3 p = m.points[t.v[k]];
      p[axis] = -p[axis] + 0.0;
      const auto image = at.find({p[0], p[1], p[2]});  // to the last bit
      v[k] = image == at.end() ? -1 : image->second;
    }
    std::sort(v.begin(), v.end());
    if (!tets.contains(v)) out.push_back(t);
  }
  return out;
}

TEST(Primitives, MeshesAreTheirOwnMirrorImages) {
  const TetMesh meshes[] = {box({0.017, 0.013, 0.004}, 0.001),
                            box({3, 2, 1}, 0.5),
                            box({1, 1, 1}, std::array<Index, 3>{2, 4, 6}),
                            sphere(1, 0.3),
                            sphere(1, 0.25),
                            cylinder(1, 1.7, 0.3),
                            cylinder(1, 1.7, 0.25),
                            capsule(1, 1.7, 0.3),
                            capsule(1, 0.1, 0.25)};
  for (std::size_t i = 0; i < std::size(meshes); ++i)
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(without_image(meshes[i], axis).size(), i == 8 && axis == 2 ? 6 * 8u * 8 : 0u) << "mesh " << i << ", axis " << axis;
}

TEST(Primitives, OddNumbersOfCellsLeaveAMiddleLayer) {
  const TetMesh m = box({1, 1, 1}, std::array<Index, 3>{5, 2, 1});
  for (const Tet& t : without_image(m, 0))
    for (Index v : t.v) EXPECT_LT(std::abs(m.points[v][0]), 0.11);
  EXPECT_EQ(without_image(m, 0).size(), 6u * 2);
  EXPECT_EQ(without_image(m, 1).size(), 0u);
  EXPECT_EQ(without_image(m, 2).size(), 6u * 5 * 2);
}

TEST(Primitives, EdgeLengthsGiveEvenNumbersOfCells) {
  for (const auto& [length, planes] : {std::pair{0.5, 1.0}, std::pair{1.49, 1.0}, std::pair{1.5, 1.5}, std::pair{2.9, 1.5}, std::pair{3.0, 2.5},
                                       std::pair{4.9, 2.5}, std::pair{5.0, 3.5}})
    EXPECT_EQ(box({0.1 * length, 0.1, 0.1}, 0.1).points.size(), 8 * planes) << length;
}

// What stiff bodies are made of, without their insides.
TEST(Primitives, SkinsAreSurfacesToTheLastBit) {
  for (const Grid& grid : {box_grid({1, 1, 1}, 1), box_grid({1, 2, 3}, 1), box_grid({0.5, 0.9, 0.3}, 0.1), sphere_grid(1, 0.5), sphere_grid(1, 0.11),
                           cylinder_grid(1, 0.3, 0.5), cylinder_grid(0.2, 1, 0.06), capsule_grid(0.3, 0.4, 0.1)}) {
    const TriMesh expected = surface_of(solid(grid)), got = skin(grid);
    ASSERT_EQ(got.points.size(), expected.points.size());
    ASSERT_EQ(got.triangles.size(), expected.triangles.size());
    for (std::size_t i = 0; i < got.points.size(); ++i) ASSERT_EQ(got.points[i], expected.points[i]);
    for (std::size_t t = 0; t < got.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) ASSERT_EQ(got.triangles[t].v[k], expected.triangles[t].v[k]);
  }
}

// Before anything of that size is made.
TEST(Primitives, TooManyVerticesAreRefused) {
  const Grid grid = box_grid({1, 1, 1}, 1.0 / 2000);
  EXPECT_THROW(solid(grid), Error);
  EXPECT_THROW(skin(grid), Error);
}

TEST(Primitives, Deterministic) {
  const TetMesh a = capsule(0.3, 0.4, 0.1), b = capsule(0.3, 0.4, 0.1);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) ASSERT_EQ(a.points[i], b.points[i]);
}

}  // namespace
}  // namespace mortise::geometry
