// The pure mathematics of barrier_contact: barrier, distance stencils, mollified edge pairs.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "effects/contact/stencil.h"
#include "geometry/collide/mollifier.h"

namespace mortise::effects::contact {
namespace {

using geometry::Feature;

struct Dense {
  bool positive_only = false;
  Mat12 H = Mat12::Zero();
  void operator()(double c, const Vec3* v) {
    if (positive_only && !(c > 0)) return;
    Vec12 p;
    for (int i = 0; i < 4; ++i) p.segment<3>(3 * i) = v[i];
    H += c * p * p.transpose();
  }
};

struct Case {
  Vec3 x[4];
  bool edges = false;
  double eps = 0;
};

Closest classify(const Case& k, const Vec12& q) {
  Vec3 x[4];
  for (int i = 0; i < 4; ++i) x[i] = q.segment<3>(3 * i);
  return k.edges ? geometry::closest_edge_edge(x) : geometry::closest_point_triangle(x);
}

double energy(const Case& k, const Vec12& q, double d_hat, Vec12* g = nullptr, Mat12* H = nullptr, bool projected = false) {
  Vec3 x[4], grad[4];
  for (int i = 0; i < 4; ++i) x[i] = q.segment<3>(3 * i);
  Dense dense{projected};
  Frame f;
  const double e = evaluate(classify(k, q), x, d_hat, 1.0, k.eps, H != nullptr, f, grad, dense);
  if (g)
    for (int i = 0; i < 4; ++i) g->segment<3>(3 * i) = grad[i];
  if (H) *H = dense.H;
  return e;
}

Vec12 flat(const Case& k) {
  Vec12 q;
  for (int i = 0; i < 4; ++i) q.segment<3>(3 * i) = k.x[i];
  return q;
}

struct Errors {
  double gradient = 0, hessian = 0, negative = 0, force = 0, moment = 0;
};

// Fourth-order central differences with a step of `h`.
Errors compare(const Case& k, double d_hat, double h) {
  const Vec12 q = flat(k);
  Vec12 g, difference;
  Mat12 H, projected, dH;
  energy(k, q, d_hat, &g, &H);
  energy(k, q, d_hat, nullptr, &projected, true);
  for (int i = 0; i < 12; ++i) {
    Vec12 e = Vec12::Zero();
    e[i] = h;
    difference[i] =
        (8 * (energy(k, q + e, d_hat) - energy(k, q - e, d_hat)) - (energy(k, q + 2 * e, d_hat) - energy(k, q - 2 * e, d_hat))) / (12 * h);
    Vec12 a, b, c, d;
    energy(k, q + e, d_hat, &a), energy(k, q - e, d_hat, &b), energy(k, q + 2 * e, d_hat, &c), energy(k, q - 2 * e, d_hat, &d);
    dH.col(i) = (8 * (a - b) - (c - d)) / (12 * h);
  }
  Errors r;
  r.gradient = (g - difference).norm() / g.norm();
  r.hessian = (H - dH).norm() / H.norm();
  const auto eigen = Eigen::SelfAdjointEigenSolver<Mat12>(projected).eigenvalues();
  r.negative = -eigen.minCoeff() / eigen.maxCoeff();
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  double size = 0;
  for (int i = 0; i < 4; ++i) {
    force += g.segment<3>(3 * i);
    moment += k.x[i].cross(g.segment<3>(3 * i));
    size += g.segment<3>(3 * i).norm();
  }
  r.force = force.norm() / size, r.moment = moment.norm() / size;
  return r;
}

class Samples {
 public:
  explicit Samples(unsigned seed) : random_(seed) {}
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }
  Vec3 vec(double s) { return {uniform(-s, s), uniform(-s, s), uniform(-s, s)}; }

 private:
  std::mt19937 random_;
};

// Point over the place (l1, l2) of a random triangle, or edges crossing at (s, t), at distance g.
Case point_over(Samples& r, double l1, double l2, double g) {
  Case k;
  for (int i = 1; i < 4; ++i) k.x[i] = r.vec(1);
  const Vec3 e1 = k.x[2] - k.x[1], e2 = k.x[3] - k.x[1];
  k.x[0] = k.x[1] + l1 * e1 + l2 * e2 + g * e1.cross(e2).normalized();
  return k;
}
Case edges_at(Samples& r, double s, double t, double g, double angle) {
  Case k;
  k.edges = true;
  const Vec3 u = r.vec(1).normalized(), n = u.cross(r.vec(1)).normalized();
  const Vec3 v = std::cos(angle) * u + std::sin(angle) * n.cross(u), p = r.vec(1);
  k.x[0] = p - s * u, k.x[1] = p + (1 - s) * u;
  k.x[2] = p + g * n - t * v, k.x[3] = p + g * n + (1 - t) * v;
  k.eps = geometry::mollifier_threshold(k.x);
  return k;
}

void expect_good(const Case& k, double d_hat, double h, Errors& worst, const char* what) {
  if (energy(k, flat(k), d_hat) == 0) return;
  const Errors e = compare(k, d_hat, h);
  EXPECT_LT(e.gradient, 1e-6) << what;
  EXPECT_LT(e.hessian, 1e-5) << what;
  EXPECT_LT(e.negative, 1e-12) << what;
  EXPECT_LT(e.force, 1e-12) << what;
  EXPECT_LT(e.moment, 1e-11) << what;
  worst.gradient = std::max(worst.gradient, e.gradient);
  worst.hessian = std::max(worst.hessian, e.hessian);
}

TEST(BarrierStencil, HalfOfAnAngleWithoutTrigonometry) {
  for (double p : {-3.0, -1e-200, -0.0, 0.0, 1e-9, 2.0})
    for (double q : {-4.0, -1e-12, -0.0, 0.0, 1e-200, 0.5}) {
      double cs, sn;
      half_angle(p, q, cs, sn);
      const double angle = p * p + q * q > 0 ? 0.5 * std::atan2(q, p) : 0;
      EXPECT_NEAR(cs, std::cos(angle), 1e-15) << p << " " << q;
      EXPECT_NEAR(std::fabs(sn), std::fabs(std::sin(angle)), 1e-15) << p << " " << q;
      if (q != 0) {
        EXPECT_GE(cs * sn * q, 0) << p << " " << q;
      }
    }
}

TEST(Barrier, DerivativesMatchDifferences) {
  const double d = 0.3;
  for (double t : {1e-3, 0.05, 0.3, 0.7, 0.99}) {
    const double g = t * d, h = 1e-5 * g;
    const double b1 =
        (8 * (barrier::value(g + h, d) - barrier::value(g - h, d)) - (barrier::value(g + 2 * h, d) - barrier::value(g - 2 * h, d))) / (12 * h);
    const double b2 =
        (8 * (barrier::first(g + h, d) - barrier::first(g - h, d)) - (barrier::first(g + 2 * h, d) - barrier::first(g - 2 * h, d))) / (12 * h);
    EXPECT_NEAR(b1 / barrier::first(g, d), 1, 1e-8) << t;
    EXPECT_NEAR(b2 / barrier::second(g, d), 1, 1e-8) << t;
  }
  EXPECT_EQ(barrier::value(d, d), 0);
  EXPECT_EQ(barrier::first(d, d), 0);
  EXPECT_EQ(barrier::second(d, d), 0);
}

// Benchmark B27: p/kappa = 2(s-1) ln s + (s-1)^2/s, tabulated solutions and the identity itself.
TEST(Barrier, GapAtAPressure) {
  const double table[][2] = {{1e-6, .99942}, {1e-5, .99818}, {1e-4, .99424}, {1e-3, .98185}, {1e-2, .94338},
                             {.1, .82853},   {1, .53244},    {10, .12215},   {100, .01075},  {1000, .00101}};
  for (const auto& [P, s] : table) {
    const double t = barrier::phi_inverse(P);
    EXPECT_NEAR(t, s, 6e-6) << P;
    EXPECT_NEAR((2 * (t - 1) * std::log(t) + (t - 1) * (t - 1) / t) / P, 1, 1e-8) << P;
    EXPECT_NEAR(-barrier::first(t * 0.2, 0.2) / P, 1, 1e-8) << P;
  }
}

TEST(BarrierStencil, PointTriangleEverywhere) {
  Samples r(1);
  Errors worst;
  for (int i = 0; i < 300; ++i) {
    const double g = r.uniform(0.02, 0.5);
    expect_good(point_over(r, r.uniform(-0.6, 1.2), r.uniform(-0.6, 1.2), g), 0.6, 2e-5, worst, "random");
  }
  ::testing::Test::RecordProperty("gradient", std::to_string(worst.gradient));
  std::printf("PT random: gradient %.1e hessian %.1e\n", worst.gradient, worst.hessian);
}

TEST(BarrierStencil, PointNearFeatureBoundaries) {
  Samples r(2);
  Errors worst;
  // On either side of an edge or a vertex, away from it by more than the difference step.
  for (double off : {2e-3, -2e-3})
    for (int i = 0; i < 40; ++i) {
      expect_good(point_over(r, off, 0.4, 0.2), 0.6, 1e-5, worst, "edge");
      expect_good(point_over(r, off, 2 * off, 0.2), 0.6, 1e-5, worst, "vertex");
    }
  std::printf("PT near boundaries: gradient %.1e hessian %.1e\n", worst.gradient, worst.hessian);
}

TEST(BarrierStencil, TinyGaps) {
  Samples r(3);
  Errors worst;
  for (double g : {1e-3, 1e-5, 1e-6})
    for (int i = 0; i < 20; ++i) {
      expect_good(point_over(r, r.uniform(0.1, 0.4), r.uniform(0.1, 0.4), g), 0.1, 1e-3 * g, worst, "point");
      expect_good(edges_at(r, r.uniform(0.1, 0.9), r.uniform(0.1, 0.9), g, r.uniform(0.3, 2.8)), 0.1, 1e-3 * g, worst, "edges");
    }
  std::printf("tiny gaps: gradient %.1e hessian %.1e\n", worst.gradient, worst.hessian);
}

TEST(BarrierStencil, EdgeEdgeEverywhere) {
  Samples r(4);
  Errors worst;
  for (int i = 0; i < 300; ++i)
    expect_good(edges_at(r, r.uniform(-0.3, 1.3), r.uniform(-0.3, 1.3), r.uniform(0.05, 0.5), r.uniform(0.1, 3.0)), 0.6, 2e-5, worst, "random");
  std::printf("EE random: gradient %.1e hessian %.1e\n", worst.gradient, worst.hessian);
}

TEST(BarrierStencil, NearlyParallelEdges) {
  Samples r(5);
  Errors worst;
  int mollified = 0;
  for (double angle : {2.5e-2, 1e-2, 3e-3})
    for (int i = 0; i < 40; ++i) {
      const Case k = edges_at(r, r.uniform(0.3, 0.7), r.uniform(0.3, 0.7), r.uniform(0.05, 0.5), angle);
      mollified += geometry::mollifier(k.x, k.eps) < 1;
      expect_good(k, 0.6, 2e-4 * angle, worst, "parallel");
    }
  EXPECT_EQ(mollified, 120);
  // Exactly parallel: no energy, no force, and a finite Hessian.
  Case k = edges_at(r, 0.5, 0.5, 0.1, 0.0);
  k.x[0] = {0, 0, 0}, k.x[1] = {1, 0, 0}, k.x[2] = {0.2, 0, 0.1}, k.x[3] = {1.2, 0, 0.1};
  Vec12 g;
  Mat12 H;
  EXPECT_EQ(energy(k, flat(k), 0.6, &g, &H), 0);
  EXPECT_EQ(g.norm(), 0);
  EXPECT_TRUE(H.allFinite());
  std::printf("EE nearly parallel: gradient %.1e hessian %.1e\n", worst.gradient, worst.hessian);
}

// Value and gradient do not jump where the closest feature changes.
TEST(BarrierStencil, ContinuousAcrossFeatures) {
  Samples r(6);
  for (int i = 0; i < 50; ++i)
    for (double l2 : {0.4, 0.0}) {
      Case a = point_over(r, 0, l2, 0.2), b = a;
      const Vec3 shift = (a.x[2] - a.x[1]) * 1e-9 + (l2 == 0 ? Vec3((a.x[3] - a.x[1]) * 1e-9) : Vec3::Zero());
      a.x[0] -= shift, b.x[0] += shift;
      Vec12 ga, gb;
      const double ea = energy(a, flat(a), 0.6, &ga), eb = energy(b, flat(b), 0.6, &gb);
      EXPECT_NEAR(ea, eb, 1e-7 * ea);
      EXPECT_LT((ga - gb).norm(), 1e-6 * ga.norm());
    }
}

TEST(BarrierStencil, RigidMotionChangesNothing) {
  Samples r(7);
  for (int i = 0; i < 50; ++i) {
    Case k = i % 2 ? point_over(r, 0.2, 0.3, 0.1) : edges_at(r, 0.4, 0.6, 0.1, i % 4 ? 0.01 : 1.0);
    Case m = k;
    const Mat3 R = Eigen::AngleAxisd(r.uniform(0, 3), r.vec(1).normalized()).toRotationMatrix();
    const Vec3 p = r.vec(1);
    for (Vec3& x : m.x) x = R * x + p;
    Vec12 ga, gb;
    EXPECT_NEAR(energy(k, flat(k), 0.6, &ga) / energy(m, flat(m), 0.6, &gb), 1, 1e-11);
    for (int j = 0; j < 4; ++j) EXPECT_LT((R * ga.segment<3>(3 * j) - gb.segment<3>(3 * j)).norm(), 1e-9 * ga.norm());
  }
}

}  // namespace
}  // namespace mortise::effects::contact
