// Angles of hinges, their stops, and the laws of drives: derivatives by differences at random and adversarial states.
#include <gtest/gtest.h>

#include <random>

#include "effects/drive/law.h"
#include "effects/joint/stop.h"
#include "finite_difference.h"
#include "model/coordinate.h"

using namespace mortise;
using namespace mortise::fd;
using effects::drive::Law;

namespace {

// E(theta) with E' and E'' of any size.
struct Wave {
  MORTISE_HD double energy(double x) const { return 2 * x + 1.5 * x * x; }
  MORTISE_HD double first(double x) const { return 2 + 3 * x; }
  MORTISE_HD double second(double) const { return 3; }
  MORTISE_HD double up(double) const { return INFINITY; }
  MORTISE_HD double down(double) const { return INFINITY; }
};

struct HingeProblem {
  model::Hinge hinge;
  Vector q;  // columns of both bodies
  double before = 0;

  // Two bodies turned by `angle` against each other, the whole turned at random and every column shaken by `strain`.
  HingeProblem(double angle, double strain, bool world, unsigned seed) {
    std::mt19937_64 rng(seed);
    std::normal_distribution<double> n;
    const Vec3 u = Vec3(n(rng), n(rng), n(rng)).normalized();
    hinge = model::hinge_about(u, 0, world ? -1 : 3);
    const Mat3 all = Eigen::AngleAxisd(n(rng), Vec3(n(rng), n(rng), n(rng)).normalized()).toRotationMatrix();
    const Mat3 A = world ? Mat3(Mat3::Identity()) : all, R = A * Eigen::AngleAxisd(angle, u).toRotationMatrix();
    q.resize(18);
    for (int i = 0; i < 3; ++i) q.segment<3>(3 * i) = R.col(i), q.segment<3>(9 + 3 * i) = A.col(i);
    for (Eigen::Index i = 0; i < q.size(); ++i) q[i] += strain * n(rng);
    before = angle;
  }
  model::HingeDirections at(const Vector& x) const {
    const std::vector<Vec3> blocks = blocks_of(x);
    return model::directions(hinge, {blocks.data(), static_cast<Index>(blocks.size())});
  }
  double angle(const Vector& x) const { return model::unwrapped(model::hinge_angle(at(x)), before); }
  template <class L>
  std::pair<Vector, Matrix> stencil(const L& law, const Vector& x, double concave) const {
    Index block[6];
    Vec3 grad[6];
    Mat3 hess[21];
    const double a = angle(x);
    model::hinge_stencil(hinge, at(x), law.first(a), law.second(a), concave, block, grad, hess);
    Vector g = Vector::Zero(18);
    Matrix H = Matrix::Zero(18, 18);
    for (Index i = 0; i < 6; ++i) {
      if (block[i] < 0) continue;
      g.segment<3>(3 * block[i]) += grad[i];
      for (Index j = i; j < 6; ++j) {
        if (block[j] < 0) continue;
        const Mat3& h = hess[linalg::pair_place(i, j, 6)];
        H.block<3, 3>(3 * block[i], 3 * block[j]) += h;
        if (i != j) H.block<3, 3>(3 * block[j], 3 * block[i]) += h.transpose();
      }
    }
    return {g, H};
  }
};

// Moment of the forces -g on the columns of a body.
Vec3 moment(const Vector& q, const Vector& g, int first) {
  Vec3 m = Vec3::Zero();
  for (int i = 0; i < 3; ++i) m -= Vec3(q.segment<3>(3 * (first + i))).cross(Vec3(g.segment<3>(3 * (first + i))));
  return m;
}

}  // namespace

TEST(Hinges, AngleIsThatOfTheTurn) {
  for (bool world : {false, true})
    for (double angle : {-3.1, -1.0, 0.0, 1e-9, 0.7, 3.14, 100.0}) {
      const HingeProblem p(angle, 0, world, 3);
      EXPECT_NEAR(p.angle(p.q), angle, 1e-13 * std::max(1.0, std::abs(angle)));
    }
}

TEST(Hinges, DerivativesAreExact) {
  for (bool world : {false, true})
    for (double angle : {-M_PI + 1e-3, -1.2, 0.0, 0.4, 1.5707963, M_PI, 7.9})
      for (double strain : {0.0, 0.05, 0.4})
        for (unsigned seed : {1u, 2u, 3u}) {
          const HingeProblem p(angle, strain, world, seed);
          const Wave law;
          const auto d = p.at(p.q);
          const double r = std::hypot(model::sine(d), model::cosine(d));
          if (r < 0.5) continue;  // nearer to a collapsed body differences lose their digits before formulas do
          const auto [g, H] = p.stencil(law, p.q, 1);
          const Vector dg = difference_gradient([&](const Vector& x) { return law.energy(p.angle(x)); }, p.q, 1e-3);
          const Matrix dH = difference_jacobian([&](const Vector& x) { return p.stencil(law, x, 1).first; }, p.q, 1e-3);
          Vector free = dg;
          Matrix free_H = dH;
          if (world) free.tail(9).setZero(), free_H.rightCols(9).setZero();
          EXPECT_LT(relative_error(g, free), 1e-8) << angle << " " << strain << " " << world;
          EXPECT_LT(relative_error(H, free_H), 1e-8) << angle << " " << strain << " " << world;
          EXPECT_GT(lowest_eigenvalue(p.stencil(law, p.q, 0).second), -1e-12);
          // What acts on one body acts back on the other: no moment is left, whatever the strain.
          EXPECT_LT(world ? 0 : (moment(p.q, g, 0) + moment(p.q, g, 3)).norm(), 1e-13 * g.norm() * p.q.norm());
          // Rigid bodies are turned, about the axis and with the whole torque, and not strained.
          if (strain == 0 && !world) {
            const Vec3 u = p.hinge.e2.cross(p.hinge.e3);
            Mat3 A, F;
            for (int i = 0; i < 3; ++i) A.col(i) = p.q.segment<3>(9 + 3 * i), F.col(i) = g.segment<3>(3 * i);
            EXPECT_LT((moment(p.q, g, 0) + law.first(angle) * (A * u)).norm(), 1e-12 * std::abs(law.first(angle)));
            Mat3 R;
            for (int i = 0; i < 3; ++i) R.col(i) = p.q.segment<3>(3 * i);
            const Mat3 stress = R.transpose() * F;
            EXPECT_LT((stress + stress.transpose()).norm(), 1e-12 * F.norm());
          }
        }
}

// The way up to an angle is where the angle is that.
TEST(Hinges, WayUpToAnAngle) {
  std::mt19937_64 rng(7);
  std::normal_distribution<double> n;
  int reached = 0;
  for (int i = 0; i < 400; ++i) {
    const HingeProblem p(n(rng), 0.05, i % 2, 100 + i);
    Vector w(18);
    for (Eigen::Index k = 0; k < 18; ++k) w[k] = n(rng);
    const auto change = [&] {
      const std::vector<Vec3> blocks = blocks_of(w);
      return model::directions(p.hinge, {blocks.data(), 6}, true);
    }();
    const double up = std::abs(n(rng)) * 0.3 + 1e-6, down = std::abs(n(rng)) * 0.3 + 1e-6, start = p.angle(p.q);
    const double alpha = model::hinge_way(p.at(p.q), change, up, down);
    ASSERT_GT(alpha, 0);
    const double end = std::min(alpha, 1.0);
    for (int k = 1; k <= 200; ++k) {
      HingeProblem near = p;
      near.before = start;
      const double turned = near.angle(p.q + end * k / 200 * w) - start;
      EXPECT_LE(turned, up + 1e-9) << alpha;
      EXPECT_GE(turned, -down - 1e-9) << alpha;
    }
    if (alpha > 1) continue;
    ++reached;
    HingeProblem near = p;
    near.before = start;
    const double turned = near.angle(p.q + alpha * w) - start;
    EXPECT_LT(std::min(std::abs(turned - up), std::abs(turned + down)), 1e-7);
  }
  EXPECT_GT(reached, 200);
}

// The way of a slide on a body that is anywhere, strained and turned, and on the world.
TEST(SlideCoordinate, DerivativesAreExact) {
  std::mt19937_64 rng(11);
  std::normal_distribution<double> n;
  for (bool world : {false, true})
    for (int i = 0; i < 20; ++i) {
      model::Coordinate c;
      c.slides = true, c.slider = 0, c.carrier = world ? -1 : 1, c.at_rest = 0.3;
      c.u = Vec3(n(rng), n(rng), n(rng)).normalized(), c.X = Vec3(n(rng), n(rng), n(rng));
      Vector q(15);
      for (Eigen::Index k = 0; k < 15; ++k) q[k] = n(rng);
      const Wave law;
      const auto value = [&](const Vector& x) {
        const std::vector<Vec3> blocks = blocks_of(x);
        return model::coordinate(c, model::reading(c, {blocks.data(), 5}));
      };
      const auto stencil = [&](const Vector& x) {
        const std::vector<Vec3> blocks = blocks_of(x);
        Index block[6];
        Vec3 grad[6];
        Mat3 hess[21];
        const double s = value(x);
        model::coordinate_stencil(c, model::reading(c, {blocks.data(), 5}), law.first(s), law.second(s), 1, block, grad, hess);
        std::pair<Vector, Matrix> out{Vector::Zero(15), Matrix::Zero(15, 15)};
        for (Index a = 0; a < 6; ++a) {
          if (block[a] < 0) continue;
          out.first.segment<3>(3 * block[a]) += grad[a];
          for (Index b = a; b < 6; ++b) {
            if (block[b] < 0) continue;
            const Mat3& h = hess[linalg::pair_place(a, b, 6)];
            out.second.block<3, 3>(3 * block[a], 3 * block[b]) += h;
            if (a != b) out.second.block<3, 3>(3 * block[b], 3 * block[a]) += h.transpose();
          }
        }
        return out;
      };
      const auto [g, H] = stencil(q);
      EXPECT_LT(relative_error(g, difference_gradient([&](const Vector& x) { return law.energy(value(x)); }, q, 1e-3)), 1e-8);
      EXPECT_LT(relative_error(H, difference_jacobian([&](const Vector& x) { return stencil(x).first; }, q, 1e-3)), 1e-8);
      if (world) continue;
      // Neither force nor moment is left.
      EXPECT_LT((g.segment<3>(0) + g.segment<3>(3)).norm(), 1e-13 * g.norm());
      Vec3 moment = Vec3::Zero();
      for (int b = 0; b < 5; ++b) moment += Vec3(q.segment<3>(3 * b)).cross(Vec3(g.segment<3>(3 * b)));
      EXPECT_LT(moment.norm(), 1e-12 * g.norm() * q.norm());
      // And the way up to a stop ends there.
      Vector w(15);
      for (Eigen::Index k = 0; k < 15; ++k) w[k] = n(rng);
      const std::vector<Vec3> at = blocks_of(q), way = blocks_of(w);
      const double alpha = model::coordinate_way(c, model::reading(c, {at.data(), 5}), model::reading(c, {way.data(), 5}, true), value(q), 0.2, 0.1),
                   end = std::min(alpha, 1.0);
      for (int k = 1; k <= 100; ++k) {
        const double gone = value(q + end * k / 100 * w) - value(q);
        EXPECT_LE(gone, 0.2 + 1e-9);
        EXPECT_GE(gone, -0.1 - 1e-9);
      }
      if (alpha > 1) continue;
      EXPECT_NEAR(std::min(std::abs(value(q + alpha * w) - value(q) - 0.2), std::abs(value(q + alpha * w) - value(q) + 0.1)), 0, 1e-9);
    }
}

TEST(Stops, DerivativesAreExact) {
  const effects::stop::Stops s{-0.3, 0.9, 0.06, 5};
  for (double x : {-0.2999, -0.29, -0.26, -0.243, 0.0, 0.5, 0.85, 0.88, 0.8999}) {
    const double h = 1e-3 * std::min({0.06, x - s.low, s.high - x});
    EXPECT_NEAR(s.first(x), (8 * (s.energy(x + h) - s.energy(x - h)) - s.energy(x + 2 * h) + s.energy(x - 2 * h)) / (12 * h),
                1e-7 * (1 + std::abs(s.first(x))));
    EXPECT_NEAR(s.second(x), (8 * (s.first(x + h) - s.first(x - h)) - s.first(x + 2 * h) + s.first(x - 2 * h)) / (12 * h), 1e-7 * (1 + s.second(x)));
    EXPECT_GE(s.second(x), 0);
  }
  EXPECT_EQ(s.energy(-0.31), INFINITY);
  EXPECT_EQ(s.energy(0.9), INFINITY);
  EXPECT_EQ(s.first(0.2), 0);
}

namespace {

std::vector<Law> laws() {
  std::vector<Law> out;
  for (double a : {-30.0, -2.0, 0.0, 0.3, 8.0})
    for (double K : {0.0, 4.0, 3000.0})
      for (double effort : {0.7, 25.0, static_cast<double>(INFINITY)})
        for (double velocity : {2.0, static_cast<double>(INFINITY)}) {
          if (effort == INFINITY && velocity < INFINITY) continue;
          Law l;
          l.a = a, l.K = K, l.effort = effort, l.velocity = velocity, l.h = 0.005, l.pace = 200, l.damping = 0.02, l.dry = 0.1;
          out.push_back(l);
          l.pace = 300, l.drift = -0.7;  // BDF2
          out.push_back(l);
          l.stiffness = 3, l.stretch = -0.2, l.armature = 1e-3, l.rate = 0.7;
          out.push_back(l);
        }
  return out;
}

}  // namespace

// The energy is the integral of the torque across all its kinks, the torque falls, and keeps to its limits.
TEST(DriveLaw, EnergyIsTheIntegral) {
  for (const Law& l : laws())
    for (double x : {-0.05, -0.0099, -0.003, -1e-7, 0.0, 2e-6, 0.002, 0.00905, 0.0095, 0.02}) {
      const int n = 20000;
      double sum = 0;
      for (int i = 0; i < n; ++i) {
        const double y = x * (i + 0.5) / n;
        sum += l.first_of(y) * x / n;
      }
      EXPECT_NEAR(l.energy_of(x) - l.energy_of(0), sum, 1e-6 * (std::abs(sum) + std::abs(x * l.first_of(x))) + 1e-12)
          << l.a << " " << l.K << " " << l.effort << " " << l.velocity << " " << x;
      const double tau = l.motor(x), v = l.rate_of(x);
      EXPECT_LE(std::abs(tau), l.effort);
      EXPECT_LE(l.motor(x + 1e-4), tau + 1e-12);
      EXPECT_LE(v >= l.velocity ? tau : 0, 0);
      EXPECT_GE(v <= -l.velocity ? tau : 0, 0);
      EXPECT_EQ(tau, l.effort == INFINITY ? l.a - l.K * x : tau);
    }
}

TEST(DriveLaw, DerivativesAreExactBetweenKinks) {
  int seen = 0;
  for (const Law& l : laws())
    for (double x : {-0.013, -0.0095, -0.004, -3e-6, 2e-6, 0.0021, 0.0093, 0.015}) {
      const double h = 1e-8 * (std::abs(x) + 1e-3);
      const auto slope = [&](auto f) { return (f(x + h) - f(x - h)) / (2 * h); };
      if (l.motor_falls(x + 2 * h) != l.motor_falls(x - 2 * h)) continue;
      ++seen;
      EXPECT_NEAR(l.second_of(x), slope([&](double y) { return l.first_of(y); }), 1e-4 * (1 + l.second_of(x)));
      EXPECT_GE(l.second_of(x), 0);
      EXPECT_NEAR(l.first_of(x), slope([&](double y) { return l.energy_of(y); }), 1e-4 * (1 + std::abs(l.first_of(x))));
    }
  EXPECT_GT(seen, 300);
}
