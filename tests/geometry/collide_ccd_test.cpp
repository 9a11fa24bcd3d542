#include <gtest/gtest.h>

#include "collide_helpers.h"
#include "geometry/collide/ccd.h"
#include "geometry/collide/step_limit.h"

namespace mortise::geometry {
namespace {

using device::Buffer;

struct Motion {
  Vec3 x0[4], x1[4];
  double distance(double t, bool edges) const {
    Vec3 x[4];
    for (int i = 0; i < 4; ++i) x[i] = x0[i] + t * (x1[i] - x0[i]);
    return std::sqrt((edges ? closest_edge_edge(x) : closest_point_triangle(x)).squared);
  }
  double impact(bool edges, double min_distance = 0, double t_max = 1) const {
    return edges ? ccd_edge_edge(x0, x1, min_distance, t_max) : ccd_point_triangle(x0, x1, min_distance, t_max);
  }
};

Motion random_motion(test::Random& r, double size, double speed) {
  Motion m;
  for (int i = 0; i < 4; ++i) {
    m.x0[i] = test::random_vec(r, size);
    m.x1[i] = m.x0[i] + test::random_vec(r, speed);
  }
  return m;
}

// Shifts the first primitive so that the pair touches at time t, somewhere inside or on the border of both primitives.
void plant(test::Random& r, Motion& m, bool edges, double t) {
  double a = test::uniform(r, 0, 1), b = test::uniform(r, 0, 1);
  if (r() % 4 == 0) a = 0;
  if (r() % 4 == 0) b = edges ? 1 : 0;
  if (!edges && a + b > 1) a = 1 - a, b = 1 - b;
  Vec3 x[4];
  for (int i = 0; i < 4; ++i) x[i] = m.x0[i] + t * (m.x1[i] - m.x0[i]);
  const Vec3 gap = edges ? Vec3((1 - a) * x[0] + a * x[1] - (1 - b) * x[2] - b * x[3]) : Vec3(x[0] - (1 - a - b) * x[1] - a * x[2] - b * x[3]);
  for (int i = 0; i < (edges ? 2 : 1); ++i) m.x0[i] -= gap, m.x1[i] -= gap;
}

TEST(Ccd, NeverMissesAPlantedImpact) {
  test::Random r(21);
  for (int trial = 0; trial < 20000; ++trial) {
    const bool edges = trial % 2;
    const double size = std::pow(10, test::uniform(r, -3, 1));
    Motion m = random_motion(r, size, size * std::pow(10, test::uniform(r, -4, 1)));
    if (trial % 5 == 0) m.x0[3] = m.x0[2] + 1e-7 * test::random_vec(r, size);  // almost degenerate at the start
    const double t = test::uniform(r, 0, 1);
    plant(r, m, edges, t);
    const double found = m.impact(edges);
    ASSERT_LE(found, t + 1e-9) << trial;
    ASSERT_GE(found, 0);
    // Not needlessly early: at the time found the pair is all but in contact.
    ASSERT_LE(m.distance(found, edges), 1e-5 * size * 20) << trial;
  }
}

TEST(Ccd, PairsStayApartBeforeTheTimeFound) {
  test::Random r(22);
  int hits = 0, misses = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const bool edges = trial % 2;
    const Motion m = random_motion(r, 1, 2);
    const double found = m.impact(edges);
    (found <= 1 ? hits : misses)++;
    const double start = m.distance(0, edges);
    if (start > 1e-6) {
      ASSERT_GT(found, 0);
    }
    // Sampling cannot prove a miss, but it refutes one: a pair that passes through changes sides, so the least distance is small.
    for (int k = 0; k < 50; ++k) {
      const double t = std::min(found, 1.0) * k / 50;
      ASSERT_GT(m.distance(t, edges), 0);
    }
    if (found <= 1) {
      ASSERT_LE(m.distance(found, edges), 1e-5) << trial;
    }
  }
  EXPECT_GT(hits, 200);
  EXPECT_GT(misses, 200);
}

TEST(Ccd, PassesCloseByWithoutAHit) {
  for (const double gap : {1e-3, 1e-6, 1e-9}) {
    const Motion slide{{Vec3(-5, 0.2, gap), Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)},
                       {Vec3(5, 0.2, gap), Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}};
    EXPECT_EQ(slide.impact(false), kNoImpact) << gap;
    const Motion edges{{Vec3(-5, -1, gap), Vec3(-5, 1, gap), Vec3(-1, 0, 0), Vec3(1, 0, 0)},
                       {Vec3(5, -1, gap), Vec3(5, 1, gap), Vec3(-1, 0, 0), Vec3(1, 0, 0)}};
    EXPECT_EQ(edges.impact(true), kNoImpact) << gap;
    // Parallel edges, one above the other.
    const Motion parallel{{Vec3(-5, 0, gap), Vec3(-4, 0, gap), Vec3(-1, 0, 0), Vec3(1, 0, 0)},
                          {Vec3(5, 0, gap), Vec3(6, 0, gap), Vec3(-1, 0, 0), Vec3(1, 0, 0)}};
    EXPECT_EQ(parallel.impact(true), kNoImpact) << gap;
  }
}

TEST(Ccd, RespectsMinimumDistanceAndEndTime) {
  // Falls from height 1 at speed 2: at 0.1 above the triangle after 0.45, on it after 0.5.
  const Motion fall{{Vec3(0.2, 0.2, 1), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)},
                    {Vec3(0.2, 0.2, -1), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}};
  EXPECT_NEAR(fall.impact(false), 0.5, 1e-5);
  EXPECT_LE(fall.impact(false), 0.5);
  EXPECT_NEAR(fall.impact(false, 0.1), 0.45, 1e-5);
  EXPECT_LE(fall.impact(false, 0.1), 0.45);
  EXPECT_EQ(fall.impact(false, 0, 0.4), kNoImpact);
  EXPECT_NEAR(fall.impact(false, 0, 0.6), 0.5, 1e-5);
  const Motion cross{{Vec3(-1, 0, 1), Vec3(1, 0, 1), Vec3(0, -1, 0), Vec3(0, 1, 0)},
                     {Vec3(-1, 0, -3), Vec3(1, 0, -3), Vec3(0, -1, 0), Vec3(0, 1, 0)}};
  EXPECT_NEAR(cross.impact(true), 0.25, 1e-5);
  EXPECT_LE(cross.impact(true), 0.25);
}

TEST(Ccd, DegenerateMotion) {
  Motion still{};
  for (int i = 0; i < 4; ++i) still.x0[i] = still.x1[i] = Vec3(i == 1, i == 2, i == 3);
  EXPECT_EQ(still.impact(false), kNoImpact);
  EXPECT_EQ(still.impact(true), kNoImpact);
  Motion point{};  // everything in one point
  for (int i = 0; i < 4; ++i) point.x0[i] = point.x1[i] = Vec3(1, 2, 3);
  EXPECT_EQ(point.impact(false), 0);
  EXPECT_EQ(point.impact(true), 0);
  Motion unknown = still;
  unknown.x1[0][1] = std::nan("");
  EXPECT_EQ(unknown.impact(false), 0);
  unknown = still;
  unknown.x0[0][1] = std::nan("");
  EXPECT_EQ(unknown.impact(true), 0);
}

// The first time at which the distance is `target`, by fine sampling and bisection; 2 if there is none.
double sampled_time(const Motion& m, bool edges, double target) {
  constexpr int n = 2000;
  for (int k = 1; k <= n; ++k)
    if (m.distance(double(k) / n, edges) < target) {
      double lo = double(k - 1) / n, hi = double(k) / n;
      for (int i = 0; i < 40; ++i) {
        const double mid = (lo + hi) / 2;
        (m.distance(mid, edges) < target ? hi : lo) = mid;
      }
      return lo;
    }
  return 2;
}

TEST(StepLimit, KeepsItsShareOfTheDistanceAndIsNotTimid) {
  test::Random r(23);
  const double keep = 0.1;
  int limited = 0, timid = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const bool edges = trial % 2;
    const Motion m = random_motion(r, 1, std::pow(10, test::uniform(r, -1, 1)));
    const double start = m.distance(0, edges), t = detail::step_limit(m.x0, m.x1, edges, keep), truth = sampled_time(m, edges, keep * start);
    ASSERT_LE(t, truth + 1e-12) << trial;
    ASSERT_GT(t, 0);
    if (t > 1) continue;
    ++limited;
    timid += t < 0.95 * std::min(truth, 1.0);
    ASSERT_LE(m.distance(t, edges), (keep + 0.0101 * (1 - keep)) * start) << trial;
  }
  EXPECT_GT(limited, 100);
  EXPECT_LE(timid, limited / 10);  // pairs that pass each other at little more than the distance to keep
}

TEST(StepLimit, IsPositiveWheneverThereIsADistance) {
  for (const double gap : {1e-3, 1e-9, 1e-14, 1e-17, 1e-100, 1e-150})
    for (const double speed : {1e-12, 1.0, 1e3}) {
      const Motion m{{Vec3(0.3, 0.3, gap), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)},
                     {Vec3(0.3, 0.3, gap - speed), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}};
      const double t = detail::step_limit(m.x0, m.x1, false, 0.1);
      EXPECT_GT(t, 0) << gap << " " << speed;
      if (speed > gap && gap > 1e-15) {  // below that the positions themselves are not that exact
        EXPECT_LT(t * speed, 0.901 * gap);
      }
      // Away from the triangle nothing is in the way.
      const Motion away{{m.x0[0], m.x0[1], m.x0[2], m.x0[3]}, {Vec3(0.3, 0.3, gap + speed), m.x0[1], m.x0[2], m.x0[3]}};
      EXPECT_GT(detail::step_limit(away.x0, away.x1, false, 0.1), gap > 1e-13 ? 1 : 0) << gap << " " << speed;
    }
  const Motion touching{{Vec3(0.25, 0.25, 0), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)},
                        {Vec3(0.25, 0.25, -1), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}};
  EXPECT_EQ(detail::step_limit(touching.x0, touching.x1, false, 0.1), 0);
}

// Orientation of four points, with products in 113 bits: independent of everything above and all but exact.
__extension__ typedef __float128 Quad;
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  Quad m[3][3];
  for (int k = 0; k < 3; ++k) {
    m[0][k] = Quad(a[k]) - Quad(d[k]);
    m[1][k] = Quad(b[k]) - Quad(d[k]);
    m[2][k] = Quad(c[k]) - Quad(d[k]);
  }
  const Quad det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                   m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return det > 0 ? 1 : det < 0 ? -1 : 0;
}
bool crosses(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const int above = orientation(a, b, c, p), below = orientation(a, b, c, q);
  if (above * below >= 0) return false;
  const int s = orientation(p, q, a, b), t = orientation(p, q, b, c), u = orientation(p, q, c, a);
  return (s >= 0 && t >= 0 && u >= 0) || (s <= 0 && t <= 0 && u <= 0);
}
int intersections(const test::Soup& s, const std::vector<Vec3>& y) {
  int n = 0;
  for (const Triangle& t : s.triangles) {
    const Vec3 &a = y[t.v[0]], &b = y[t.v[1]], &c = y[t.v[2]];
    const Vec3 lo = a.cwiseMin(b).cwiseMin(c), hi = a.cwiseMax(b).cwiseMax(c);
    for (const Edge& e : s.edges) {
      const Vec3 &p = y[e.v[0]], &q = y[e.v[1]];
      if (s.env[e.v[0]] != s.env[t.v[0]] || (p.cwiseMax(q).array() < lo.array()).any() || (p.cwiseMin(q).array() > hi.array()).any()) continue;
      bool shared = false;
      for (Index v : t.v) shared = shared || v == e.v[0] || v == e.v[1];
      if (!shared) n += crosses(p, q, a, b, c);
    }
  }
  return n;
}

// Layers of rough sheets are pushed into each other. Each soup takes a few steps only: every limited step may use up 90 % of the
// least distance, and below 1e-14 of the size of the sheets positions in double have no room left.
TEST(StepLimit, SoupsNeverIntersect) {
  int limited = 0, would_intersect = 0;
  for (int trial = 0; trial < 4; ++trial) {
    test::Random r(24 + trial);
    test::Soup s;
    constexpr int envs = 2, layers = 4;
    for (int e = 0; e < envs; ++e)
      for (int b = 0; b < layers; ++b) test::add_patch(s, r, 5, 1, Vec3(0.1 * b, 0.05 * b, 0.15 * b), e);
    s.allowed.assign(s.bodies * s.bodies, 1);
    const Surface surface = s.surface();
    Broadphase pairs(surface);
    std::vector<Vec3> y = s.points;
    ASSERT_EQ(intersections(s, y), 0);
    for (int step = 0; step < 10; ++step) {
      std::vector<Vec3> dy(y.size()), whole(y.size());
      for (std::size_t i = 0; i < y.size(); ++i) {
        const double layer = s.body[i] % layers;
        dy[i] = test::random_vec(r, step % 3 == 0 ? 0.2 : 0.05) + Vec3(0.02 * layer, 0, 0.1 * (1.5 - layer));
        whole[i] = y[i] + dy[i];
      }
      would_intersect += intersections(s, whole) > 0;
      const Buffer<Vec3> yb(y), dyb(dy);
      pairs.update(yb.view(), dyb.view(), 0);
      std::vector<double> alpha(envs, 1.0);
      device::Fetch fetch;
      limit_step(pairs, yb.view(), dyb.view(), 0.1, {alpha, fetch});
      fetch.now();
      for (double a : alpha) {
        ASSERT_GT(a, 0);
        ASSERT_LE(a, 1);
        limited += a < 1;
      }
      for (std::size_t i = 0; i < y.size(); ++i) y[i] += alpha[s.env[i]] * dy[i];
      ASSERT_EQ(intersections(s, y), 0) << "soup " << trial << " step " << step;
    }
  }
  EXPECT_GT(limited, 40);
  EXPECT_GT(would_intersect, 25);
}

TEST(StepLimit, EnvironmentsAreIndependent) {
  // Environment 0 falls onto a triangle, environment 1 moves away, environment 2 has nothing to hit.
  test::Soup s;
  const std::vector<Vec3> low{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, high{Vec3(0, 0, 1), Vec3(1, 0, 1), Vec3(0, 1, 1)};
  for (int e = 0; e < 2; ++e) s.add_body(low, {{{0, 1, 2}}}, e), s.add_body(high, {{{0, 1, 2}}}, e);
  s.add_body(low, {{{0, 1, 2}}}, 2);
  s.allowed.assign(25, 1);
  std::vector<Vec3> dy(s.points.size(), Vec3::Zero());
  for (int i = 3; i < 6; ++i) dy[i] = Vec3(0, 0, -2), dy[i + 6] = Vec3(0, 0, 2);
  const Surface surface = s.surface();
  const Buffer<Vec3> y(s.points), d(dy);
  Broadphase pairs(surface);
  pairs.update(y.view(), d.view(), 0);
  std::vector<double> alpha{1, 0.7, 1};
  device::Fetch fetch;
  limit_step(pairs, y.view(), d.view(), 0.1, {alpha, fetch});
  fetch.now();
  EXPECT_NEAR(alpha[0], 0.45, 1e-9);
  EXPECT_EQ(alpha[1], 0.7);
  EXPECT_EQ(alpha[2], 1);
}

}  // namespace
}  // namespace mortise::geometry
