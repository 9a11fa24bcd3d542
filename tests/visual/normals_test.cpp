#include "visual/normals.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sphere_mesh.h"

namespace mortise::visual {
namespace {

// A cube of twelve triangles, outward.
const std::vector<Vec3> kCube{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
const std::vector<Triangle> kCubeFaces{{{0, 2, 1}}, {{0, 3, 2}}, {{4, 5, 6}}, {{4, 6, 7}}, {{0, 1, 5}}, {{0, 5, 4}},
                                       {{2, 3, 7}}, {{2, 7, 6}}, {{1, 2, 6}}, {{1, 6, 5}}, {{3, 0, 4}}, {{3, 4, 7}}};

TEST(SplitCreases, GivesACubeItsSixFlatFaces) {
  const SplitSurface s = split_creases(kCube, kCubeFaces, 0.7);
  EXPECT_EQ(s.source.size(), 24u);
  ASSERT_EQ(s.triangles.size(), kCubeFaces.size());
  for (std::size_t t = 0; t < s.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(s.source[s.triangles[t].v[k]], kCubeFaces[t].v[k]);
      EXPECT_NEAR(s.normals[s.triangles[t].v[k]].cwiseAbs().maxCoeff(), 1, 1e-14);
    }
}

TEST(SplitCreases, LeavesASmoothSurfaceWhole) {
  const test::SphereMesh sphere(3, 1);
  const SplitSurface s = split_creases(sphere.points, sphere.triangles, 0.7);
  EXPECT_EQ(s.source.size(), sphere.points.size());
  for (std::size_t i = 0; i < s.source.size(); ++i) EXPECT_GT(s.normals[i].dot(sphere.points[s.source[i]]), 0.999);
}

// Two halves of a sphere with their points doubled along the cut, as a texture seam does.
TEST(SmoothNormals, AgreeAcrossATextureSeam) {
  const test::SphereMesh sphere(4, 1);
  std::vector<Vec3> points = sphere.points;
  std::vector<Triangle> triangles = sphere.triangles;
  std::vector<std::pair<Index, Index>> seam;
  std::vector<Index> twin(points.size(), -1);
  for (Triangle& t : triangles) {
    if (points[t.v[0]].x() + points[t.v[1]].x() + points[t.v[2]].x() < 0) continue;
    for (Index& v : t.v) {
      if (std::abs(points[v].x()) > 1e-12) continue;
      if (twin[v] < 0) {
        twin[v] = static_cast<Index>(points.size());
        points.push_back(Vec3(points[v]));
        seam.emplace_back(v, twin[v]);
      }
      v = twin[v];
    }
  }
  ASSERT_EQ(seam.size(), 64u);
  std::vector<Vec3> stretched, normals = points;
  const SmoothNormals smooth(points, normals, triangles);
  for (const Vec3& p : points) stretched.push_back({p.x(), 0.5 * p.y(), 2 * p.z()});
  smooth.compute(stretched, normals);
  for (const auto& [a, b] : seam) EXPECT_EQ(normals[a], normals[b]);
  for (std::size_t i = 0; i < points.size(); ++i)  // gradient of the ellipsoid's equation
    EXPECT_GT(normals[i].dot(Vec3(points[i].x(), points[i].y() / 0.5, points[i].z() / 2).normalized()), 0.997);
}

TEST(SmoothNormals, KeepCreasesSharp) {
  const SplitSurface s = split_creases(kCube, kCubeFaces, 0.7);
  std::vector<Vec3> points, normals = s.normals;
  for (const Index i : s.source) points.push_back(kCube[i]);
  const SmoothNormals smooth(points, normals, s.triangles);
  const Mat3 R = Eigen::AngleAxisd(0.4, Vec3(1, 1, 0).normalized()).toRotationMatrix();
  for (Vec3& p : points) p = R * p;
  smooth.compute(points, normals);
  for (std::size_t i = 0; i < normals.size(); ++i) EXPECT_LT((normals[i] - R * s.normals[i]).norm(), 1e-14);
}

}  // namespace
}  // namespace mortise::visual
