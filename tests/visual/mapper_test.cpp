#include "visual/mapper.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "sphere_mesh.h"

namespace mortise::visual {
namespace {

using test::SphereMesh;

constexpr double kRadius = 0.02;

double largest_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

// Bend, twist and stretch of about a third: smooth, far from rigid.
Vec3 deform(const Vec3& x) {
  const Vec3 s = x / kRadius;
  return kRadius * Vec3(s.x() * (1 + 0.3 * s.z()) + 0.2 * s.y() * s.y(), s.y() + 0.25 * std::sin(s.x() * s.z()), 0.7 * s.z() + 0.15 * s.x() * s.x());
}

std::vector<Vec3> moved(const std::vector<Vec3>& points, const auto& f) {
  std::vector<Vec3> out;
  for (const Vec3& x : points) out.push_back(f(x));
  return out;
}

TEST(Mapper, ReturnsTheRestShape) {
  const SphereMesh simulation(3, kRadius), model(5, 1.03 * kRadius);
  std::vector<Vec3> out;
  Mapper(simulation.points, simulation.triangles, model.points).map(simulation.points, out);
  EXPECT_LT(largest_distance(out, model.points), 1e-12 * kRadius);
}

TEST(Mapper, FollowsRigidMotionExactly) {
  const SphereMesh simulation(3, kRadius), model(5, 1.05 * kRadius);
  const Mapper mapper(simulation.points, simulation.triangles, model.points);
  const Mat3 R = Eigen::AngleAxisd(2.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  const auto motion = [&](const Vec3& x) -> Vec3 { return R * x + Vec3(0.3, -0.1, 0.7); };
  std::vector<Vec3> out;
  mapper.map(moved(simulation.points, motion), out);
  EXPECT_LT(largest_distance(out, moved(model.points, motion)), 1e-12);
}

// A curved model over ever finer facets: the distance between them shrinks with h^2, and so must the error.
TEST(Mapper, IsSecondOrderUnderASmoothDeformation) {
  const SphereMesh model(6, kRadius);
  const std::vector<Vec3> exact = moved(model.points, deform);
  std::vector<double> error;
  for (int level = 2; level <= 5; ++level) {
    const SphereMesh simulation(level, kRadius);
    std::vector<Vec3> out;
    Mapper(simulation.points, simulation.triangles, model.points).map(moved(simulation.points, deform), out);
    error.push_back(largest_distance(out, exact));
  }
  for (std::size_t k = 1; k < error.size(); ++k) EXPECT_GE(std::log2(error[k - 1] / error[k]), 1.8) << "level " << k + 2;
  EXPECT_LT(error.back(), 0.01 * kRadius);
}

TEST(Mapper, FieldsKeepTheirRange) {
  const SphereMesh simulation(2, kRadius), model(4, 1.2 * kRadius);
  std::vector<double> values, out;
  for (const Vec3& x : simulation.points) values.push_back(x.z() / kRadius);
  Mapper(simulation.points, simulation.triangles, model.points).interpolate(values, out);
  ASSERT_EQ(out.size(), model.points.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    EXPECT_LE(std::abs(out[i]), 1.0);
    EXPECT_NEAR(out[i], model.points[i].z() / (1.2 * kRadius), 0.1);
  }
}

TEST(Mapper, FindsTheNearestTriangle) {
  // Two sheets, a millimetre apart: a vertex close to the upper one moves with the upper one.
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1e-3}, {1, 0, 1e-3}, {0, 1, 1e-3}};
  const Mapper mapper(points, {{{0, 1, 2}}, {{3, 4, 5}}}, {{0.2, 0.2, 0.8e-3}, {0.2, 0.2, 0.1e-3}});
  std::vector<Vec3> lifted = points, out;
  for (int i = 3; i < 6; ++i) lifted[i].z() += 1;
  mapper.map(lifted, out);
  EXPECT_NEAR(out[0].z(), 1.8e-3 - 1e-3 + 1, 1e-12);
  EXPECT_NEAR(out[1].z(), 0.1e-3, 1e-12);
}

TEST(Mapper, NeedsASurface) { EXPECT_THROW(Mapper({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{{0, 1, 2}}}, {{0, 0, 0}}), Error); }

}  // namespace
}  // namespace mortise::visual
