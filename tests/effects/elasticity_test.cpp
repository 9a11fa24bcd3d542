#include "effects/elasticity/elasticity.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "problem.h"

using namespace mortise;
using namespace mortise::effects;
using model::MaterialModel;

namespace {

using Mat9 = Eigen::Matrix<double, 9, 9>;
using Vec9 = Eigen::Matrix<double, 9, 1>;

constexpr double kMu = 0.7, kLambda = 2.3;
constexpr MaterialModel kModels[] = {MaterialModel::linear, MaterialModel::corotated, MaterialModel::neo_hookean};

struct Random {
  std::mt19937_64 rng{11};
  double operator()(double a = -1, double b = 1) { return std::uniform_real_distribution<double>(a, b)(rng); }
  Mat3 matrix() {
    Mat3 m;
    for (int i = 0; i < 9; ++i) m.data()[i] = (*this)();
    return m;
  }
  Mat3 rotation() {
    Eigen::Quaterniond r((*this)(), (*this)(), (*this)(), (*this)());
    return r.normalized().toRotationMatrix();
  }
};

// Deformation gradients that break careless code: rotated far, nearly flat, flat, inverted, stretched a lot, at rest.
std::vector<Mat3> hard_deformations() {
  Random r;
  std::vector<Mat3> list{Mat3::Identity()};
  const std::vector<Vec3> stretches = {{1, 1, 1},    {1.2, 0.9, 0.8}, {1, 1, 1e-3},  {1, 1, -1e-3},     {1.1, 0.7, -0.4},
                                       {5, 2, 0.05}, {1, 1, 0},       {0.3, 0.2, 0}, {1.5, 1e-3, 1e-4}, {2, 1.9, -1.2}};
  for (const Vec3& s : stretches)
    for (int k = 0; k < 3; ++k) list.push_back(r.rotation() * s.asDiagonal() * r.rotation());
  for (int k = 0; k < 10; ++k) list.push_back(Mat3::Identity() + 0.5 * r.matrix());
  for (int k = 0; k < 10; ++k) list.push_back(r.rotation() + 1e-4 * r.matrix());
  return list;
}

// True where the corotated rotation is (nearly) undefined: two signed singular values that cancel.
bool corotated_is_singular(const Mat3& F) {
  const Vec3 s = linalg::svd3(F).s;
  return s[1] + s[2] < 0.05;
}

// The laws without the guard against inversion, which would make inverted states infinite.
double law_density(MaterialModel model, const Mat3& F) { return elasticity::law_density(model, F, kMu, kLambda); }
Mat3 law_stress(MaterialModel model, const Mat3& F) { return elasticity::law_stress(model, F, kMu, kLambda); }

Vec9 flat(const Mat3& m) { return Eigen::Map<const Vec9>(m.data()); }
Mat3 square(const Vec9& v) { return Eigen::Map<const Mat3>(v.data()); }

// d^2 Psi / dF^2 as a 9x9 matrix, column-major in F, put together from the blocks that assembly uses: with g_b = e_b, x_b is column b.
Mat9 density_hessian(MaterialModel model, const Mat3& F, bool projected) {
  Mat9 H;
  linalg::IsotropicModes m;
  if (model == MaterialModel::corotated) m = elasticity::corotated_modes(F, kMu, kLambda);
  if (model == MaterialModel::neo_hookean) m = elasticity::neo_hookean_modes(F, kMu, kLambda);
  if (projected && model != MaterialModel::linear) linalg::scale_concave(m, 0);
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      const Vec3 ga = Vec3::Unit(a), gb = Vec3::Unit(b);
      H.block<3, 3>(3 * a, 3 * b) = model == MaterialModel::linear ? elasticity::linear_block(ga, gb, kMu, kLambda)
                                                                   : linalg::hessian_block(m, m.V.transpose() * ga, m.V.transpose() * gb);
    }
  return H;
}

Mat9 clamped(const Mat9& H) {
  const Eigen::SelfAdjointEigenSolver<Mat9> e(0.5 * (H + H.transpose()));
  return e.eigenvectors() * e.eigenvalues().cwiseMax(0).asDiagonal() * e.eigenvectors().transpose();
}

}  // namespace

TEST(Svd3, RebuildsFromRotationsOnHardMatrices) {
  Random r;
  std::vector<Mat3> list = hard_deformations();
  list.push_back(Mat3::Zero());
  list.push_back(Vec3(1, 2, 3) * Vec3(3, 1, -2).transpose());
  list.push_back(1e-60 * r.matrix());
  list.push_back(1e60 * r.matrix());
  list.push_back(Mat3::Ones());
  list.push_back(-Mat3::Identity());
  for (const Mat3& F : list) {
    const linalg::Svd3 d = linalg::svd3(F);
    const double size = std::max(F.norm(), 1e-300);
    EXPECT_LT((d.U * d.s.asDiagonal() * d.V.transpose() - F).norm() / size, 1e-14) << F;
    EXPECT_LT((d.U.transpose() * d.U - Mat3::Identity()).norm(), 1e-14) << F;
    EXPECT_LT((d.V.transpose() * d.V - Mat3::Identity()).norm(), 1e-14) << F;
    EXPECT_NEAR(d.U.determinant(), 1, 1e-13);
    EXPECT_NEAR(d.V.determinant(), 1, 1e-13);
    EXPECT_GE(d.s[0], d.s[1]);
    EXPECT_GE(d.s[1] * (1 + 1e-14), std::abs(d.s[2]));
  }
}

TEST(Svd3, SmallSingularValuesKeepTheirDigits) {
  // columns of very different length: the smallest singular value is known to full relative precision
  Mat3 F = Mat3::Zero();
  F(0, 0) = 1, F(1, 1) = 1e-9, F(2, 2) = -1e-12, F(0, 1) = 1e-9;
  const linalg::Svd3 d = linalg::svd3(F);
  EXPECT_NEAR(d.s[1] / 1e-9, 1, 1e-9);
  EXPECT_NEAR(d.s[2] / -1e-12, 1, 1e-12);
}

TEST(JacobiEigen, AgreesWithEigenAndProjects) {
  Random r;
  for (int k = 0; k < 50; ++k) {
    Eigen::Matrix<double, 6, 6> A;
    for (int i = 0; i < 36; ++i) A.data()[i] = r();
    A = (A + A.transpose()).eval();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> e(A);
    Eigen::Matrix<double, 6, 6> P = A;
    linalg::project_psd<6>(P);
    EXPECT_LT((P - e.eigenvectors() * e.eigenvalues().cwiseMax(0).asDiagonal() * e.eigenvectors().transpose()).norm(), 1e-13 * A.norm());
    Eigen::Matrix<double, 6, 6> D = A, Q;
    linalg::jacobi_eigen<6>(D, Q);
    EXPECT_LT((Q * D * Q.transpose() - A).norm(), 1e-14 * A.norm() * 10);
  }
}

TEST(Elasticity, DensityStressAndHessianAreDerivativesOfEachOther) {
  double worst_gradient = 0, worst_hessian = 0;
  for (MaterialModel model : kModels)
    for (const Mat3& F : hard_deformations()) {
      if (model == MaterialModel::corotated && corotated_is_singular(F)) continue;
      auto psi = [&](const fd::Vector& x) { return law_density(model, square(x)); };
      auto P = [&](const fd::Vector& x) -> fd::Vector { return flat(law_stress(model, square(x))); };
      const fd::Vector x = flat(F);
      const double h = 1e-3;
      const double g = fd::relative_error(P(x), fd::difference_gradient(psi, x, h), kMu);
      const double H = fd::relative_error(density_hessian(model, F, false), fd::difference_jacobian(P, x, h));
      EXPECT_LT(g, 1e-6) << int(model) << "\n" << F;
      EXPECT_LT(H, 1e-5) << int(model) << "\n" << F;
      worst_gradient = std::max(worst_gradient, g), worst_hessian = std::max(worst_hessian, H);
    }
  std::printf("worst relative errors: gradient %.1e, Hessian %.1e\n", worst_gradient, worst_hessian);
}

TEST(Elasticity, AnalyticProjectionEqualsEigenvalueClamping) {
  int projected = 0;
  for (MaterialModel model : kModels)
    for (const Mat3& F : hard_deformations()) {
      if (model == MaterialModel::corotated && corotated_is_singular(F)) continue;
      const Mat9 exact = density_hessian(model, F, false), ours = density_hessian(model, F, true), theirs = clamped(exact);
      EXPECT_LT((ours - theirs).norm() / theirs.norm(), 1e-10) << int(model) << "\n" << F;
      EXPECT_LT((ours - ours.transpose()).norm() / ours.norm(), 1e-14);
      projected += (ours - exact).norm() > 1e-3 * exact.norm();
    }
  EXPECT_GT(projected, 20);  // the list must contain states where there is something to clamp
}

TEST(Elasticity, ProjectedHessianIsFiniteWhereTheRotationJumps) {
  Random r;
  const Mat3 F = r.rotation() * Vec3(1, 0.5, -0.5).asDiagonal() * r.rotation();
  const Mat9 H = density_hessian(MaterialModel::corotated, F, true);
  EXPECT_TRUE(H.allFinite());
  EXPECT_TRUE(density_hessian(MaterialModel::corotated, Mat3::Zero(), true).allFinite());
  EXPECT_GE(fd::lowest_eigenvalue(0.5 * (H + H.transpose())), -1e-14);
}

TEST(Elasticity, GuardIsItsOwnDerivativeAndGoesToInfinity) {
  Random r;
  for (MaterialModel model : kModels)
    for (double J : {0.095, 0.05, 1e-2, 1e-3, 3e-5})
      for (int shape = 0; shape < 3; ++shape) {
        const Vec3 s = shape == 0   ? Vec3(1.1, 0.9, J / 0.99)
                       : shape == 1 ? Vec3(1.7, std::sqrt(J), std::sqrt(J) / 1.7)
                                    : Vec3::Constant(std::cbrt(J));
        const Mat3 F = r.rotation() * s.asDiagonal() * r.rotation();
        // The guard and its derivatives change over a share of J: steps must be small against the smallest singular value.
        const double h = 1e-3 * s.minCoeff();
        auto psi = [&](const fd::Vector& x) { return elasticity::density(model, square(x), kMu, kLambda); };
        auto P = [&](const fd::Vector& x) -> fd::Vector { return flat(elasticity::stress(model, square(x), kMu, kLambda)); };
        const linalg::IsotropicModes m = elasticity::modes(model, F, kMu, kLambda);
        Mat9 H;
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) {
            H.block<3, 3>(3 * a, 3 * b) = linalg::hessian_block(m, m.V.transpose() * Vec3::Unit(a), m.V.transpose() * Vec3::Unit(b));
            if (model == MaterialModel::linear) H.block<3, 3>(3 * a, 3 * b) += elasticity::linear_block(Vec3::Unit(a), Vec3::Unit(b), kMu, kLambda);
          }
        EXPECT_LT(fd::relative_error(P(flat(F)), fd::difference_gradient(psi, flat(F), h), kMu), 1e-6) << int(model) << " " << J << "\n" << F;
        EXPECT_LT(fd::relative_error(H, fd::difference_jacobian(P, flat(F), h)), 1e-5) << int(model) << " " << J << "\n" << F;
      }
  for (MaterialModel model : kModels) {
    const Mat3 F = Vec3(1, 1, elasticity::kGuarded).asDiagonal();
    EXPECT_EQ(elasticity::density(model, F, kMu, kLambda), law_density(model, F));  // nothing above J_0
    EXPECT_EQ(elasticity::stress(model, F, kMu, kLambda), law_stress(model, F));
    EXPECT_EQ(elasticity::density(model, Vec3(1, 1, 0).asDiagonal(), kMu, kLambda), INFINITY);
    EXPECT_EQ(elasticity::density(model, Vec3(1, 1, -0.5).asDiagonal(), kMu, kLambda), INFINITY);
    EXPECT_EQ(elasticity::density(model, Vec3(-1, -1, -1).asDiagonal(), kMu, kLambda), INFINITY);
  }
}

TEST(Elasticity, RestIsStressFreeAndRotationCostsNothing) {
  Random r;
  for (MaterialModel model : kModels) {
    EXPECT_EQ(elasticity::density(model, Mat3::Identity(), kMu, kLambda), 0);
    EXPECT_LT(elasticity::stress(model, Mat3::Identity(), kMu, kLambda).norm(), 1e-15);
    if (model == MaterialModel::linear) continue;
    const Mat3 R = r.rotation();
    EXPECT_NEAR(elasticity::density(model, R, kMu, kLambda), 0, 1e-15);
    EXPECT_LT(elasticity::stress(model, R, kMu, kLambda).norm(), 1e-14);
  }
}

// Rounding of the energy is that of the strain, not that of the modulus: a line search in a body that had turned ended in it.
TEST(Elasticity, TurningHidesNoEnergy) {
  Random r;
  for (MaterialModel model : {MaterialModel::corotated, MaterialModel::neo_hookean})
    for (int k = 0; k < 50; ++k) {
      const Mat3 F = Mat3::Identity() + 1e-7 * r.matrix();
      const double at_rest = elasticity::density(model, F, kMu, kLambda);
      EXPECT_NEAR(elasticity::density(model, r.rotation() * F, kMu, kLambda), at_rest, 1e-7 * at_rest);
    }
}

TEST(Elasticity, AllMaterialsMatchLinearElasticityAtSmallStrain) {
  Random r;
  for (MaterialModel model : kModels)
    EXPECT_LT((density_hessian(model, Mat3::Identity(), false) - density_hessian(MaterialModel::linear, Mat3::Identity(), false)).norm(), 1e-13);
  // and the energy has all its digits there: a strain of 1e-7 costs 1e-14 Pa, compared to a relative 1e-6
  Mat3 E = r.matrix();
  E = (E + E.transpose()).eval();
  const Mat3 F = Mat3::Identity() + 1e-7 * E;
  for (MaterialModel model : kModels) {
    const double linear = elasticity::linear_density(F, kMu, kLambda);
    EXPECT_NEAR(elasticity::density(model, F, kMu, kLambda) / linear, 1, 1e-6) << int(model);
  }
}

TEST(Elasticity, ElementGradientAndHessian) {
  Random r;
  for (MaterialModel model : kModels)
    for (const bool squashed : {false, true}) {
      Mat3 Dm = Mat3::Identity() + 0.3 * r.matrix();
      Dm *= 2e-3;  // a 2 mm element
      const elasticity::Element e{Dm.inverse(), std::abs(Dm.determinant()) / 6, 1e5, 4e5, model};
      std::vector<Vec3> x(4);
      x[0] = Vec3(0.01, 0.02, -0.03);
      // Squashed: where the guard acts. Its derivatives change within a share of the smallest stretch.
      const Mat3 stretch = squashed ? Mat3(Vec3(1.1, 0.9, 0.05).asDiagonal() * r.rotation()) : Mat3(Mat3::Identity() + 0.3 * r.matrix());
      const double h = squashed ? 1e-7 : 2e-6;
      const Mat3 Ds = r.rotation() * stretch * Dm;
      for (int a = 0; a < 3; ++a) x[a + 1] = x[0] + Ds.col(a);
      auto F = [&](const fd::Vector& y) {
        const auto v = fd::blocks_of(y);
        return elasticity::deformation_gradient(e.dm_inverse, v[0], v[1], v[2], v[3]);
      };
      auto E = [&](const fd::Vector& y) { return elasticity::energy(e, F(y)); };
      auto g = [&](const fd::Vector& y) -> fd::Vector {
        std::vector<Vec3> grad(4);
        elasticity::gradient(e, F(y), grad.data());
        return fd::flatten(grad);
      };
      const fd::Vector y = fd::flatten(x);
      Mat3 hess[10];
      elasticity::hessian(e, F(y), 1, hess);
      fd::Matrix H(12, 12);
      for (int a = 0, place = 0; a < 4; ++a)
        for (int b = a; b < 4; ++b, ++place) {
          EXPECT_EQ(place, linalg::pair_place(a, b, 4));
          H.block<3, 3>(3 * a, 3 * b) = hess[place];
          H.block<3, 3>(3 * b, 3 * a) = hess[place].transpose();
        }
      EXPECT_LT(fd::relative_error(g(y), fd::difference_gradient(E, y, h)), 1e-6);
      EXPECT_LT(fd::relative_error(H, fd::difference_jacobian(g, y, h)), 1e-5);
      EXPECT_LT((H * Vec3(1, 2, 3).replicate<4, 1>()).norm(), 1e-10 * H.norm());  // translation costs nothing
    }
}

// Newton's exact matrix is put together without modes.
TEST(Elasticity, TheExactHessianIsThatOfTheModes) {
  Random r;
  for (const Mat3& F : hard_deformations()) {
    if (!(elasticity::det3(F) > elasticity::kFlattest)) continue;
    for (double pressure : {0.0, -0.8, 5.0}) {
      const Mat3 dm_inverse = Mat3::Identity() + 0.3 * r.matrix();
      const elasticity::Element e{dm_inverse, 1.3, kMu, kLambda, MaterialModel::neo_hookean, pressure};
      const linalg::IsotropicModes m = elasticity::modes(e.model, F, kMu, kLambda, pressure);
      Mat3 hess[10];
      elasticity::hessian(e, F, 1, hess);
      double difference = 0, size = 0;
      for (int a = 0, place = 0; a < 4; ++a)
        for (int b = a; b < 4; ++b, ++place) {
          const Mat3 want = e.volume * linalg::hessian_block(m, m.V.transpose() * elasticity::shape_gradient(dm_inverse, a),
                                                             m.V.transpose() * elasticity::shape_gradient(dm_inverse, b));
          difference = std::max(difference, (hess[place] - want).norm()), size = std::max(size, want.norm());
        }
      EXPECT_LT(difference, 1e-12 * size) << pressure << "\n" << F;
    }
  }
}

TEST(IsotropicModes, WhatIsClearlyPositiveNeedsNoProjection) {
  Random r;
  int clear = 0, other = 0;
  for (int k = 0; k < 2000; ++k) {
    const Mat3 Q = r.rotation();
    Mat3 A = Q * Vec3(r(-0.3, 1), r(-0.3, 1), r(-0.3, 1)).asDiagonal() * Q.transpose();
    A = (0.5 * (A + A.transpose())).eval();
    const double least = Eigen::SelfAdjointEigenSolver<Mat3>(A).eigenvalues()[0];
    const bool positive = linalg::clearly_positive(A);
    EXPECT_TRUE(least > 0 || !positive) << least;
    EXPECT_TRUE(positive || least < 1e-9) << least;
    ++(positive ? clear : other);
  }
  EXPECT_GT(clear, 300);
  EXPECT_GT(other, 300);
  EXPECT_FALSE(linalg::clearly_positive(Mat3::Zero()));
  EXPECT_FALSE(linalg::clearly_positive(Vec3(1, 0, 1).asDiagonal()));
  EXPECT_FALSE(linalg::clearly_positive(Vec3(1, std::nan(""), 1).asDiagonal()));
}

TEST(Elasticity, WholeEffectDerivatives) {
  for (const char* law : {"linear", "corotated", "neo_hookean"}) {
    model::Model m(fd::box_and_ball(law));
    const auto e = fd::make_effect("elasticity", Params::make_table(), m);
    // Slightly swollen: all eigenvalues are positive, and projection changes nothing.
    const fd::Vector x = 1.02 * fd::shaken(m, 0.002);
    const fd::Errors errors = fd::effect_errors(*e, x, 1e-3);
    EXPECT_LT(errors.gradient, 1e-6) << law;
    EXPECT_LT(errors.hessian, 1e-5) << law;
    // Crushed: the gradient stays exact, and the assembled Hessian has no negative eigenvalue.
    const fd::Vector crushed = 0.6 * fd::shaken(m, 0.3);
    const fd::Dense d = fd::effect_assemble(*e, crushed, true);
    EXPECT_LT(fd::relative_error(d.gradient, fd::difference_gradient([&](const fd::Vector& y) { return fd::effect_energy(*e, y); }, crushed, 1e-4)),
              1e-6);
    EXPECT_GT(fd::lowest_eigenvalue(d.hessian), -1e-13) << law;
  }
}

TEST(Elasticity, EnvironmentsAreCountedApart) {
  model::Model both(fd::box_and_ball("neo_hookean", 2)), one(fd::box_and_ball("neo_hookean", 1));
  const auto e2 = fd::make_effect("elasticity", Params::make_table(), both), e1 = fd::make_effect("elasticity", Params::make_table(), one);
  const fd::Vector x = fd::shaken(both, 0.05);
  const std::vector<double> energies = fd::effect_energies(*e2, x, 2);
  EXPECT_EQ(energies[0], fd::effect_energies(*e1, x.head(3 * one.blocks), 1)[0]);
  EXPECT_GT(energies[1], 0);
  EXPECT_NE(energies[0], energies[1]);
}

TEST(Elasticity, ReportsUniformStressOfAPulledBar) {
  // Uniaxial strain e in z: sigma_zz = (lambda + 2 mu) e, sigma_xx = lambda e.
  model::Model m(fd::box_and_ball("linear"));
  const double e = 1e-3, mu = 1e5 / 2.8, lambda = 1e5 * 0.4 / (1.4 * 0.2);
  std::vector<Vec3> q = m.rest.download();
  for (Index b = m.bodies[0].block_begin; b < m.bodies[0].block_end; ++b) q[b][2] *= 1 + e;
  m.q.upload(q);
  const auto effect = fd::make_effect("elasticity", Params::make_table(), m);
  fd::Recorder sink;
  effect->report(sink);
  const Index tets = m.bodies[0].tet_end, triangles = m.bodies[1].triangle_end - m.bodies[1].triangle_begin;
  ASSERT_EQ(sink.cell["von_mises"].size(), std::size_t(tets + triangles));
  ASSERT_EQ(sink.cell["cauchy_stress"].size(), 6u * (tets + triangles));
  for (Index t = 0; t < tets; ++t) {
    EXPECT_NEAR(sink.cell["cauchy_stress"][6 * t + 2], (lambda + 2 * mu) * e, 1e-7);
    EXPECT_NEAR(sink.cell["cauchy_stress"][6 * t], lambda * e, 1e-7);
    EXPECT_NEAR(sink.cell["von_mises"][t], 2 * mu * e, 1e-7);
  }
  EXPECT_TRUE(std::isnan(sink.cell["von_mises"][tets]));
  EXPECT_NEAR(sink.scalars["elasticity.det_F_min"], 1 + e, 1e-12);
  EXPECT_NEAR(sink.scalars["elasticity.energy"], 0.5 * (lambda + 2 * mu) * e * e * 2, 1e-9);
}

TEST(Elasticity, ReportedShearIsOrderedXyYzZx) {
  model::Model m(fd::box_and_ball("neo_hookean"));
  const double mu = 1e5 / 2.8;
  const Mat3 F = Mat3::Identity() + 1e-4 * (Mat3() << 0, 1, 3, 1, 0, 2, 3, 2, 0).finished();
  std::vector<Vec3> q = m.rest.download();
  for (Index b = m.bodies[0].block_begin; b < m.bodies[0].block_end; ++b) q[b] = F * q[b];
  m.q.upload(q);
  fd::Recorder sink;
  fd::make_effect("elasticity", Params::make_table(), m)->report(sink);
  const std::vector<double>& s = sink.cell["cauchy_stress"];
  EXPECT_NEAR(s[3] / (2 * mu * 1e-4), 1, 1e-3);
  EXPECT_NEAR(s[4] / (2 * mu * 2e-4), 1, 1e-3);
  EXPECT_NEAR(s[5] / (2 * mu * 3e-4), 1, 1e-3);
  EXPECT_NEAR(sink.cell["von_mises"][0] / (2 * mu * 1e-4 * std::sqrt(3 * 14.0)), 1, 1e-3);
}

TEST(Elasticity, CauchyStressOfTheLinearLawHasThePressureOfTheGuard) {
  const Mat3 F = Vec3(1, 1, 0.05).asDiagonal();
  const Mat3 guard = elasticity::cauchy_stress(MaterialModel::linear, F, kMu, kLambda) - elasticity::linear_stress(F, kMu, kLambda);
  const double h = 1e-6, pressure = (elasticity::guard_density(0.05 - h, kMu) - elasticity::guard_density(0.05 + h, kMu)) / (2 * h);
  EXPECT_GT(pressure, 0);
  EXPECT_LT((guard + pressure * Mat3::Identity()).norm(), 1e-6 * pressure);
}

TEST(Elasticity, CauchyStressTurnsWithTheBody) {
  Random r;
  const Mat3 F = Mat3::Identity() + 0.2 * r.matrix(), R = r.rotation();
  for (MaterialModel model : {MaterialModel::corotated, MaterialModel::neo_hookean}) {
    const Mat3 s = elasticity::cauchy_stress(model, F, kMu, kLambda);
    EXPECT_LT((s - s.transpose()).norm(), 1e-14);
    EXPECT_LT((elasticity::cauchy_stress(model, R * F, kMu, kLambda) - R * s * R.transpose()).norm(), 1e-14);
    // power balance: P : dF = J sigma : (dF F^-1)
    const Mat3 dF = r.matrix(), P = elasticity::stress(model, F, kMu, kLambda);
    EXPECT_NEAR(P.cwiseProduct(dF).sum(), F.determinant() * s.cwiseProduct(dF * F.inverse()).sum(), 1e-13);
  }
}
