#include "effects/affine_body/affine_body.h"

#include <gtest/gtest.h>

#include "problem.h"

using namespace mortise;
using namespace mortise::effects;

namespace {

using Mat9 = Eigen::Matrix<double, 9, 9>;
constexpr double kVk = 2.5;

std::vector<Mat3> matrices() {
  std::mt19937_64 rng(9);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Mat3> list{Mat3::Identity()};
  for (int k = 0; k < 20; ++k) {
    Mat3 m;
    for (int i = 0; i < 9; ++i) m.data()[i] = u(rng);
    list.push_back(m);  // any orientation, inverted ones included
    list.push_back(Mat3::Identity() + 0.1 * m);
    list.push_back(2 * Mat3::Identity() + m);
  }
  return list;
}

Mat9 hessian(const Mat3& A, bool projected) {
  Mat3 hess[6];
  affine_body::hessian(kVk, A, projected ? 0 : 1, hess);
  Mat9 H;
  for (int a = 0, place = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b, ++place) {
      H.block<3, 3>(3 * a, 3 * b) = hess[place];
      H.block<3, 3>(3 * b, 3 * a) = hess[place].transpose();
    }
  return H;
}

std::unique_ptr<fd::Subject> affine(model::Model& m) {
  return fd::make_effect("affine_body", fd::table({{"stiffness", Params::make_number(1e6)}}), m);
}

}  // namespace

TEST(AffineBody, EnergyGradientAndHessianAreDerivativesOfEachOther) {
  double worst_gradient = 0, worst_hessian = 0;
  for (const Mat3& A : matrices()) {
    const auto as_matrix = [](const fd::Vector& x) { return Mat3(Eigen::Map<const Mat3>(x.data())); };
    const auto E = [&](const fd::Vector& x) { return affine_body::energy(kVk, as_matrix(x)); };
    const auto g = [&](const fd::Vector& x) -> fd::Vector {
      const Mat3 G = affine_body::gradient(kVk, as_matrix(x));
      return Eigen::Map<const fd::Vector>(G.data(), 9);
    };
    const fd::Vector x = Eigen::Map<const fd::Vector>(A.data(), 9);
    worst_gradient = std::max(worst_gradient, fd::relative_error(g(x), fd::difference_gradient(E, x, 1e-3), kVk));
    worst_hessian = std::max(worst_hessian, fd::relative_error(hessian(A, false), fd::difference_jacobian(g, x, 1e-3)));
  }
  EXPECT_LT(worst_gradient, 1e-6);
  EXPECT_LT(worst_hessian, 1e-5);
  std::printf("worst relative errors: gradient %.1e, Hessian %.1e\n", worst_gradient, worst_hessian);
}

TEST(AffineBody, AnalyticProjectionEqualsEigenvalueClamping) {
  int projected = 0;
  for (const Mat3& A : matrices()) {
    const Mat9 exact = hessian(A, false), ours = hessian(A, true);
    const Eigen::SelfAdjointEigenSolver<Mat9> e(exact);
    const Mat9 theirs = e.eigenvectors() * e.eigenvalues().cwiseMax(0).asDiagonal() * e.eigenvectors().transpose();
    EXPECT_LT((ours - theirs).norm(), 1e-10 * exact.norm());
    projected += e.eigenvalues().minCoeff() < -1e-3;
  }
  EXPECT_GT(projected, 10);
}

TEST(AffineBody, RigidMotionCostsNothing) {
  model::Model m(fd::box_and_ball());
  const auto e = affine(m);
  const Mat3 R = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  std::vector<Vec3> q = m.rest.download();
  const Index b = m.bodies[1].block_begin;
  q[b] += Vec3(4, 5, 6);
  for (int k = 0; k < 3; ++k) q[b + 1 + k] = R.col(k);
  EXPECT_LT(fd::effect_energy(*e, fd::flatten(q)), 1e-20);
  EXPECT_LT(fd::effect_assemble(*e, fd::flatten(q), false).gradient.norm(), 1e-8);
}

// A way that only turns ends at a rotation, whatever its angle; and all begin as they did.
TEST(AffineBody, ArcsOnlyTurn) {
  std::mt19937 gen(7);
  std::normal_distribution<double> normal;
  const auto matrix = [&] {
    Mat3 m;
    for (int i = 0; i < 9; ++i) m.data()[i] = normal(gen);
    return m;
  };
  for (int i = 0; i < 200; ++i) {
    const Mat3 A = Eigen::Quaterniond(normal(gen), normal(gen), normal(gen), normal(gen)).normalized().toRotationMatrix();
    const Vec3 w = std::pow(10, -3 + 3 * (i / 200.0)) * Vec3(normal(gen), normal(gen), normal(gen));
    const Mat3 W = cross_matrix(w);
    EXPECT_LT((affine_body::turn(A, W * A) - w).norm(), 1e-14 * (1 + w.norm()));
    const Mat3 there = A + affine_body::bent(A, W * A, w);
    EXPECT_LT(affine_body::defect(there).norm(), 1e-13) << w.norm();
    EXPECT_LT((there - Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix() * A).norm(), 1e-13);
    const Mat3 dA = 1e-5 * matrix();
    EXPECT_LT((affine_body::bent(A, dA, affine_body::turn(A, dA)) - dA).norm(), dA.squaredNorm());
  }
}

TEST(AffineBody, WholeEffectAndReport) {
  model::Model m(fd::box_and_ball());
  const auto e = affine(m);
  const fd::Vector x = 1.3 * fd::shaken(m, 0.05);  // stretched: nothing to project
  const fd::Errors errors = fd::effect_errors(*e, x, 1e-3);
  EXPECT_LT(errors.gradient, 1e-6);
  EXPECT_LT(errors.hessian, 1e-5);
  EXPECT_GT(fd::lowest_eigenvalue(fd::effect_assemble(*e, 0.3 * x, true).hessian), -1e-13);

  // 1 % longer along one axis: energy V k (1.01^2 - 1)^2, defect 1.01^2 - 1
  std::vector<Vec3> q = m.rest.download();
  q[m.bodies[1].block_begin + 2] *= 1.01;
  EXPECT_NEAR(fd::effect_energy(*e, fd::flatten(q)) / (m.bodies[1].volume * 1e6 * 0.0201 * 0.0201), 1, 1e-9);
  m.q.upload(q);
  fd::Recorder sink;
  e->report(sink);
  EXPECT_NEAR(sink.scalars["affine_body.rigidity_defect"], 0.0201, 1e-12);
}
