#include <gtest/gtest.h>

#include "collide_helpers.h"
#include "geometry/collide/distance.h"
#include "geometry/collide/mollifier.h"

namespace mortise::geometry {
namespace {

using Real = long double;
using Point = std::array<Real, 3>;
using Points = std::array<Point, 4>;

Points lift(const Vec3 x[4]) {
  Points p;
  for (int i = 0; i < 4; ++i)
    for (int d = 0; d < 3; ++d) p[i][d] = x[i][d];
  return p;
}
Real dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point sum(const double w[4], const Points& x) {
  Point r{};
  for (int i = 0; i < 4; ++i)
    for (int d = 0; d < 3; ++d) r[d] += static_cast<Real>(w[i]) * (x[i][d] - x[0][d]);
  return r;
}

// Minimum over the free parameters of the fixed type, and (optionally) its gradient, in long double and by the normal equations.
Real fixed_type_distance(const Closest& c, const Points& x, std::array<Real, 12>* gradient = nullptr) {
  std::array<Real, 4> w{};
  for (int i = 0; i < 4; ++i) w[i] = c.w[i];
  w[0] = -(w[1] + w[2] + w[3]);
  for (int repeat = 0; repeat < 3; ++repeat) {
    Point r{};
    for (int i = 1; i < 4; ++i)
      for (int d = 0; d < 3; ++d) r[d] += w[i] * (x[i][d] - x[0][d]);
    Real beta[2] = {0, 0};
    if (c.free == 1) {
      const Point e = sum(c.dw[0], x);
      beta[0] = -dot(e, r) / dot(e, e);
    } else if (c.free == 2) {
      const Point e = sum(c.dw[0], x), f = sum(c.dw[1], x);
      const Real a = dot(e, e), b = dot(e, f), d = dot(f, f), det = a * d - b * b;
      beta[0] = (-dot(e, r) * d + dot(f, r) * b) / det;
      beta[1] = (-dot(f, r) * a + dot(e, r) * b) / det;
    }
    for (int k = 0; k < c.free; ++k)
      for (int i = 0; i < 4; ++i) w[i] += beta[k] * static_cast<Real>(c.dw[k][i]);
  }
  Point r{};
  for (int i = 1; i < 4; ++i)
    for (int d = 0; d < 3; ++d) r[d] += w[i] * (x[i][d] - x[0][d]);
  if (gradient)
    for (int i = 0; i < 4; ++i)
      for (int d = 0; d < 3; ++d) (*gradient)[3 * i + d] = 2 * w[i] * r[d];
  return dot(r, r);
}

// Central differences of step h (fourth order).
template <class F>
Vec12 differences(const Vec3 x[4], Real h, F f) {
  Vec12 g;
  for (int k = 0; k < 12; ++k) {
    const auto at = [&](int steps) {
      Points p = lift(x);
      p[k / 3][k % 3] += steps * h;
      return f(p);
    };
    g[k] = static_cast<double>((8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * h));
  }
  return g;
}

void expect_derivatives(const Closest& c, const Vec3 x[4], Real h) {
  const Vec12 g = distance_gradient(c, x);
  const Vec12 fd = differences(x, h, [&](const Points& p) { return fixed_type_distance(c, p); });
  ASSERT_LE((g - fd).norm(), 1e-6 * fd.norm() + 1e-300) << "type " << static_cast<int>(c.type);
  const Mat12 H = distance_hessian(c, x);
  Mat12 fd_H;
  for (int row = 0; row < 12; ++row)
    fd_H.row(row) = differences(x, h, [&](const Points& p) {
      std::array<Real, 12> grad;
      fixed_type_distance(c, p, &grad);
      return grad[row];
    });
  ASSERT_LE((H - fd_H).norm(), 1e-5 * fd_H.norm()) << "type " << static_cast<int>(c.type);
}

// Smallest squared distance on a fine grid of both primitives: an upper bound that comes close to the truth.
double sampled(const Vec3 x[4], bool edges, int n) {
  double best = INFINITY;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= (edges ? n : n - i); ++j) {
      const double a = double(i) / n, b = double(j) / n;
      const Vec3 r = edges ? Vec3((1 - a) * x[0] + a * x[1] - (1 - b) * x[2] - b * x[3]) : Vec3(x[0] - (1 - a - b) * x[1] - a * x[2] - b * x[3]);
      best = std::min(best, r.squaredNorm());
    }
  return best;
}

TEST(Distance, DerivativesOfRandomPairsMatchFiniteDifferences) {
  test::Random r(1);
  std::array<int, 4> seen_pt{}, seen_ee{};
  for (int trial = 0; trial < 400; ++trial) {
    const double scale = std::pow(10, test::uniform(r, -4, 1));
    Vec3 x[4];
    for (Vec3& v : x) v = scale * test::random_vec(r, 1);
    const Closest pt = closest_point_triangle(x), ee = closest_edge_edge(x);
    ++seen_pt[static_cast<int>(pt.type)], ++seen_ee[static_cast<int>(ee.type)];
    for (const Closest& c : {pt, ee}) {
      ASSERT_NEAR(c.w[0] + c.w[1] + c.w[2] + c.w[3], 0, 1e-14);
      ASSERT_NEAR(relative_position(c, x).squaredNorm(), c.squared, 1e-12 * c.squared);
      double smallest = INFINITY;  // thin configurations need small steps
      const Vec3 e = combine(c.dw[0], x), f = combine(c.dw[1], x);
      if (c.free == 2) smallest = e.cross(f).norm() / std::max(e.norm(), f.norm());
      expect_derivatives(c, x, 1e-3L * std::min(scale, smallest));
    }
  }
  for (Feature f : {Feature::point_point, Feature::point_edge, Feature::point_triangle}) EXPECT_GT(seen_pt[static_cast<int>(f)], 10);
  for (Feature f : {Feature::point_point, Feature::point_edge, Feature::edge_edge}) EXPECT_GT(seen_ee[static_cast<int>(f)], 10);
}

TEST(Distance, DerivativesOfThinAndAlmostParallelPairs) {
  test::Random r(2);
  for (const double thin : {1e-2, 1e-3, 1e-4})
    for (int trial = 0; trial < 20; ++trial) {
      // A sliver below a point, far closer than the sliver is wide or long.
      const double h = 1e-3 * thin;
      const Vec3 sliver[4] = {Vec3(0.4, thin * 0.3, h), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, thin, test::uniform(r, -0.1, 0.1) * thin)};
      const Closest pt = closest_point_triangle(sliver);
      ASSERT_EQ(pt.type, Feature::point_triangle);
      expect_derivatives(pt, sliver, 1e-3L * thin);
      // Edges crossing at a small angle.
      const Vec3 crossing[4] = {Vec3(0, -thin / 2, h), Vec3(1, thin / 2, h), Vec3(test::uniform(r, 0, 0.1), 0, 0), Vec3(1, 0, 0)};
      const Closest ee = closest_edge_edge(crossing);
      ASSERT_EQ(ee.type, Feature::edge_edge);
      expect_derivatives(ee, crossing, 1e-3L * thin);
    }
}

TEST(Distance, IsTheLeastOverBothPrimitives) {
  test::Random r(3);
  for (int trial = 0; trial < 300; ++trial) {
    Vec3 x[4];
    for (Vec3& v : x) v = test::random_vec(r, 1);
    if (trial % 3 == 1) x[3] = x[2] + 1e-9 * test::random_vec(r, 1);                   // tiny edge, needle triangle
    if (trial % 3 == 2) x[3] = x[2] + (x[1] - x[0]) + 1e-10 * test::random_vec(r, 1);  // parallel edges
    constexpr int n = 60;
    for (const bool edges : {false, true}) {
      const Closest c = edges ? closest_edge_edge(x) : closest_point_triangle(x);
      const double grid = sampled(x, edges, n), least = std::sqrt(c.squared);
      EXPECT_LE(least, std::sqrt(grid) * (1 + 1e-12));
      EXPECT_GE(least, std::sqrt(grid) - 2 * 3.5 / n);  // a grid cell's diameter
      for (int i = 0; i < 4; ++i) EXPECT_TRUE(std::abs(c.w[i]) <= 1);
    }
  }
}

TEST(Distance, DegeneratePrimitivesHaveFiniteAnswers) {
  const Vec3 p(0.2, 0.3, 0.5), a(1, 1, 1), b(3, 1, 1);
  const Vec3 point_triangle[4] = {p, a, a, a};
  EXPECT_EQ(closest_point_triangle(point_triangle).type, Feature::point_point);
  EXPECT_DOUBLE_EQ(closest_point_triangle(point_triangle).squared, (p - a).squaredNorm());
  const Vec3 needle[4] = {Vec3(2, 2, 1), a, b, Vec3(2, 1, 1)};  // collinear corners
  EXPECT_NEAR(closest_point_triangle(needle).squared, 1, 1e-14);
  const Vec3 same_line[4] = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(3, 0, 0), Vec3(4, 0, 0)};
  EXPECT_DOUBLE_EQ(closest_edge_edge(same_line).squared, 4);
  const Vec3 overlapping[4] = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.25, 0, 2), Vec3(0.75, 0, 2)};
  EXPECT_DOUBLE_EQ(closest_edge_edge(overlapping).squared, 4);
  const Vec3 two_points[4] = {a, a, p, p};
  EXPECT_DOUBLE_EQ(closest_edge_edge(two_points).squared, (p - a).squaredNorm());
  for (const Vec3* x : {point_triangle, needle, same_line, overlapping, two_points}) {
    EXPECT_TRUE(distance_hessian(closest_edge_edge(x), x).allFinite());
    EXPECT_TRUE(distance_hessian(closest_point_triangle(x), x).allFinite());
  }
}

TEST(Mollifier, DerivativesMatchFiniteDifferences) {
  test::Random r(4);
  int active = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Vec3 x[4], rest[4];
    for (Vec3& v : rest) v = test::random_vec(r, 1);
    x[0] = rest[0], x[1] = rest[1], x[2] = rest[2];
    x[3] = x[2] + 0.8 * (x[1] - x[0]) + std::pow(10, test::uniform(r, -6, 0)) * test::random_vec(r, 1);
    const double eps = mollifier_threshold(rest), m = mollifier(x, eps);
    ASSERT_GE(m, 0);
    ASSERT_LE(m, 1);
    if (mollifier_argument(x) > 0.99 * eps) {
      if (mollifier_argument(x) >= eps) {
        EXPECT_EQ(m, 1);
        EXPECT_EQ(mollifier_gradient(x, eps).norm() + mollifier_hessian(x, eps).norm(), 0);
      }
      continue;
    }
    ++active;
    const auto value = [&](const Points& p) {
      Point u, v;
      for (int d = 0; d < 3; ++d) u[d] = p[1][d] - p[0][d], v[d] = p[3][d] - p[2][d];
      const Real c = dot(u, u) * dot(v, v) - dot(u, v) * dot(u, v), e = eps;
      return (2 - c / e) * c / e;
    };
    const Vec12 g = mollifier_gradient(x, eps);
    const Vec12 fd = differences(x, 1e-5L, value);
    ASSERT_LE((g - fd).norm(), 1e-6 * fd.norm() + 1e-8);
    const Mat12 H = mollifier_hessian(x, eps);
    Mat12 fd_H;
    for (int k = 0; k < 12; ++k) {
      Vec3 lo[4], hi[4];
      for (int i = 0; i < 4; ++i) lo[i] = hi[i] = x[i];
      const double h = 1e-6;
      lo[k / 3][k % 3] -= h, hi[k / 3][k % 3] += h;
      fd_H.row(k) = (mollifier_gradient(hi, eps) - mollifier_gradient(lo, eps)) / (2 * h);
    }
    ASSERT_LE((H - fd_H).norm(), 1e-5 * fd_H.norm());
  }
  EXPECT_GT(active, 50);
}

}  // namespace
}  // namespace mortise::geometry
