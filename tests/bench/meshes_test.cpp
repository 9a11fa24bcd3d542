#include "bench/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "base/error.h"
#include "geometry/topology.h"

using namespace mortise;
using namespace mortise::bench;

namespace {

double smallest_volume(const geometry::TetMesh& mesh) {
  double least = INFINITY;
  for (const Tet& t : mesh.tets) least = std::min(least, geometry::tet_volume(mesh.points, t));
  return least;
}

// A conforming mesh's boundary is closed: every edge in two triangles.
void expect_closed(const geometry::TetMesh& mesh) {
  std::map<std::pair<Index, Index>, int> count;
  for (const Triangle& t : geometry::boundary_triangles(mesh))
    for (int k = 0; k < 3; ++k) ++count[std::minmax(t.v[k], t.v[(k + 1) % 3])];
  for (const auto& [edge, n] : count) ASSERT_EQ(n, 2);
}

}  // namespace

TEST(StudyMeshes, GradedPlanes) {
  const std::vector<double> x = graded(0.01, 4, 5, 1);
  ASSERT_EQ(x.size(), 10u);
  EXPECT_DOUBLE_EQ(x[4], 0.04);
  EXPECT_DOUBLE_EQ(x.back(), 1);
  const double q = (x[5] - x[4]) / 0.01;
  EXPECT_GT(q, 1);
  for (int i = 5; i < 9; ++i) EXPECT_NEAR((x[i + 1] - x[i]) / (x[i] - x[i - 1]), q, 1e-6);
  EXPECT_DOUBLE_EQ(graded(0, 4, 0, 2)[1], 0.5);
}

TEST(StudyMeshes, JitteredBlockFillsItsBox) {
  const Vec3 lo(1, 2, 3), hi(2, 4, 3.5);
  const geometry::TetMesh mesh = jittered_block(lo, hi, {3, 4, 2}, 0.25, 5);
  EXPECT_EQ(mesh.points.size(), 4u * 5 * 3);
  EXPECT_EQ(mesh.tets.size(), 6u * 3 * 4 * 2);
  EXPECT_NEAR(geometry::volume(mesh), 1.0, 1e-13);
  EXPECT_GT(smallest_volume(mesh), 0);
  expect_closed(mesh);
  const geometry::TriMesh surface = geometry::surface_of(mesh);
  EXPECT_NEAR(geometry::area(surface), 2 * (1 * 2 + 1 * 0.5 + 2 * 0.5), 1e-12);  // faces stay plane
  // Nodes inside do move, and the same way each time.
  const geometry::TetMesh regular = jittered_block(lo, hi, {3, 4, 2}, 0, 5), again = jittered_block(lo, hi, {3, 4, 2}, 0.25, 5);
  int moved = 0;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    moved += (mesh.points[i] - regular.points[i]).norm() > 1e-3;
    EXPECT_EQ(mesh.points[i], again.points[i]);
  }
  EXPECT_GT(moved, 20);
}

TEST(StudyMeshes, BallOctantHasPositiveCellsAndARoundSurface) {
  const double R = 2;
  for (int n : {6, 7}) {
    const std::vector<double> s = graded(0.05, n - 3, 3, 1);
    std::vector<double> t = graded(0.05, 3, n - 3, 1);
    for (double& v : t) v = 1 - v;
    std::reverse(t.begin(), t.end());
    const geometry::TetMesh mesh = ball_octant(R, s, t);
    EXPECT_GT(smallest_volume(mesh), 0) << n;
    expect_closed(mesh);
    EXPECT_NEAR(geometry::volume(mesh), std::numbers::pi * R * R * R / 6, 0.05 * R * R * R);
    EXPECT_LT(geometry::volume(mesh), std::numbers::pi * R * R * R / 6);
    int on_sphere = 0;
    for (const Vec3& x : mesh.points) {
      EXPECT_TRUE(x[0] >= 0 && x[1] >= 0 && x[2] <= 0 && x.norm() <= R * (1 + 1e-14));
      on_sphere += std::abs(x.norm() - R) < 1e-12;
    }
    const int side = n + 1;
    EXPECT_EQ(on_sphere, side * side * 3 - 3 * side + 1);  // nodes on three faces of the cube
    EXPECT_NEAR(mesh.points[0][2], -R, 1e-14);             // the pole comes first
    EXPECT_NEAR(mesh.points[1][0], R * 0.05 / std::sqrt(2.0), 1e-12);
  }
}

TEST(StudyMeshes, CylinderQuarterHasPositiveCellsAndARoundSurface) {
  const double R = 2;
  for (int n : {6, 7}) {
    std::vector<double> t = graded(0.05, 3, n - 3, 1);
    for (double& v : t) v = 1 - v;
    std::reverse(t.begin(), t.end());
    const geometry::TetMesh mesh = cylinder_quarter(R, graded(0.05, n - 3, 3, 1), t, {0, 0.5, 1});
    EXPECT_GT(smallest_volume(mesh), 0) << n;
    expect_closed(mesh);
    EXPECT_NEAR(geometry::volume(mesh), std::numbers::pi * R * R / 4, 0.05 * R * R);
    EXPECT_LT(geometry::volume(mesh), std::numbers::pi * R * R / 4);
    int outside = 0;
    for (const Vec3& x : mesh.points) outside += std::abs(std::hypot(x[0], x[2]) - R) < 1e-12;
    EXPECT_EQ(outside, 3 * (2 * n + 1));
  }
}

TEST(StudyMeshes, RingAndPunchHaveTheVolumesOfTheirPolygons) {
  const geometry::TetMesh ring = ring_quarter({1, 1.5, 2}, 8, {0, 0.25, 0.5});
  EXPECT_GT(smallest_volume(ring), 0);
  expect_closed(ring);
  const double sector = 0.5 * std::sin(std::numbers::pi / 16);  // triangle of radius 1
  EXPECT_NEAR(geometry::volume(ring), 0.5 * 8 * sector * (4 - 1), 1e-12);
  for (const double rise : {0.0, 0.3}) {
    const geometry::TetMesh punch = punch_quarter(1, rise, 0.5, 8);
    EXPECT_GT(smallest_volume(punch), 0);
    expect_closed(punch);
    EXPECT_NEAR(geometry::volume(punch), 8 * sector * (0.5 - 2 * rise / 3), 1e-12);  // prism less the cone below its lower face
  }
}

TEST(StudyMeshes, EdgesAreSplitUntilTheSizeIsReached) {
  for (const auto& [cells, vertices, tets] : {std::tuple{std::array<int, 3>{3, 3, 2}, 56u, 125u}, {std::array<int, 3>{2, 2, 2}, 32u, 70u}}) {
    const geometry::TetMesh mesh = split_to(jittered_block(Vec3::Zero(), Vec3(1, 1, 0.5), cells, 0.25, 1), vertices, tets);
    EXPECT_EQ(mesh.points.size(), vertices);
    EXPECT_EQ(mesh.tets.size(), tets);
    EXPECT_GT(smallest_volume(mesh), 0);
    expect_closed(mesh);
    EXPECT_NEAR(geometry::volume(mesh), 0.5, 1e-12);
    EXPECT_NEAR(geometry::area(geometry::surface_of(mesh)), 4, 1e-12);
    EXPECT_THROW(split_to(mesh, vertices + 1, tets + 100), Error);
  }
}

TEST(StudyMeshes, SpotsAreFineWhereBodiesTouch) {
  const Spot spot{0.05, 4, 3, 3};
  const geometry::TetMesh ball = upside_down(ball_octant(2, spot));
  EXPECT_GT(smallest_volume(ball), 0);
  EXPECT_NEAR(ball.points[0][2], 2, 1e-14);
  EXPECT_NEAR(ball.points[1][0], 0.05, 1e-4);  // sin(h/R) R
  EXPECT_NEAR(cylinder_quarter(2, spot.coarser(), {0, 1}).points[1][0], 0.055, 1e-4);
}
