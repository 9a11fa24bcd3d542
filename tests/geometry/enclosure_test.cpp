// What surfaces enclose, through the tree and by all triangles.
#include "geometry/enclosure.h"

#include <gtest/gtest.h>

#include <random>

#include "geometry/primitives.h"
#include "geometry/solid_angle.h"
#include "geometry/topology.h"

using namespace mortise;
using namespace mortise::geometry;

TEST(Enclosure, IsWhereAllTrianglesWindAround) {
  TriMesh mesh = surface_of(box({1, 0.7, 0.4}, 0.06));
  TriMesh other = mesh;  // they cross
  for (Vec3& x : other.points) x += Vec3(0.3, 0.2, 0.1);
  append(other, mesh);
  const Enclosure enclosure(mesh.points, mesh.triangles);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> in(-1, 1);
  int inside = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x(in(random), in(random), in(random));
    double angle = 0;
    for (const Triangle& t : mesh.triangles) angle += solid_angle(mesh.points[t.v[0]], mesh.points[t.v[1]], mesh.points[t.v[2]], x);
    EXPECT_EQ(enclosure.holds(x), angle > 2 * M_PI) << x.transpose();
    inside += enclosure.holds(x);
  }
  EXPECT_GT(inside, 50);
  EXPECT_LT(inside, 1000);
}

TEST(Enclosure, HoldsItsSurface) {
  const TriMesh mesh = surface_of(box({1, 1, 1}, 0.25));
  const Enclosure enclosure(mesh.points, mesh.triangles);
  for (const Vec3& x : mesh.points) EXPECT_TRUE(enclosure.holds(x));
  for (const Triangle& t : mesh.triangles) EXPECT_TRUE(enclosure.holds((mesh.points[t.v[0]] + mesh.points[t.v[1]] + mesh.points[t.v[2]]) / 3));
  EXPECT_FALSE(enclosure.holds(Vec3(0, 0, 0.5 + 1e-6)));
  EXPECT_TRUE(enclosure.holds(Vec3(0, 0, 0.5 - 1e-6)));
}

TEST(Enclosure, ReachesAsFarAsAsked) {
  const TriMesh mesh = surface_of(box({1, 0.7, 0.4}, 0.08));
  const Enclosure enclosure(mesh.points, mesh.triangles);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> in(-1, 1), of(0, 0.3);
  int near = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x(in(random), in(random), in(random)), beyond = (x.cwiseAbs() - Vec3(0.5, 0.35, 0.2)).cwiseMax(0);
    const double reach = of(random);
    EXPECT_EQ(enclosure.holds(x, reach), beyond.norm() <= reach) << x.transpose();
    near += beyond.norm() > 0 && enclosure.holds(x, reach);
  }
  EXPECT_GT(near, 100);
}
