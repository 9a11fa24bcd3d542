// The linear strategies: every environment by itself, indefinite matrices, what is kept and when it is given up.
#include "solver/linear.h"

#include <gtest/gtest.h>

#include <random>

#include "linalg/block_matrix.h"
#include "solver/linear_whole.h"
#include "solver/tuning.h"
#include "toy.h"

using namespace mortise;
using namespace mortise::solver;

namespace {

// A chain of four blocks per environment: stiffness k between neighbours, `ground` on the diagonal.
struct Chains {
  model::Model model;
  Rows rows;
  linalg::BlockMatrix A;
  device::Buffer<Vec3> b, x, q;
  std::vector<double> b2, wanted;
  Options options;

  Chains(const std::vector<double>& k, const std::vector<double>& ground) : model(toy::boxes(static_cast<int>(k.size()))) {
    rows.number(model, false);
    const Index n = rows.count();
    std::vector<std::uint64_t> keys;
    std::vector<Mat3> value;
    std::uniform_real_distribution<double> u(-1, 1);
    std::vector<Vec3> rhs;
    for (std::size_t e = 0; e < k.size(); ++e) {
      std::mt19937 own(7);
      for (Index i = 0; i < 4; ++i) {
        const Index r = static_cast<Index>(4 * e) + i;
        keys.push_back(linalg::block_key(r, r, n));
        value.push_back((ground[e] + (i == 0 || i == 3 ? 1 : 2) * k[e]) * Mat3::Identity());
        if (i < 3) keys.push_back(linalg::block_key(r, r + 1, n)), value.push_back(-k[e] * Mat3::Identity());
        rhs.push_back(Vec3(u(own), u(own), u(own)));
      }
    }
    linalg::set_pattern(device::Buffer<std::uint64_t>(keys), n, A);
    A.value.upload(value);
    b.upload(rhs), q.copy_from(model.q);
    x.resize(n);
    x.zero();
    wanted.assign(k.size(), 1e-12), b2.assign(k.size(), 0.0);
    for (Index r = 0; r < n; ++r) b2[r / 4] += rhs[r].squaredNorm();
    options.cg_forcing = false;
  }
  LinearSystem system() { return {A, std::as_const(b).view(), x.view(), b2, wanted, std::as_const(q).view()}; }
  double residual(Index env) {
    device::Buffer<Vec3> y(x.size());
    linalg::multiply(A, std::as_const(x).view(), y.view());
    const auto left = y.download(), right = b.download();
    double most = 0;
    for (Index r = 4 * env; r < 4 * env + 4; ++r) most = std::max(most, (left[r] - right[r]).norm());
    return most;
  }
};

std::unique_ptr<Linear> make(const char* kind, const Chains& c) {
  const std::string k = kind;
  return k == "cg" ? make_cg(c.model, c.rows, c.options) : make_direct(c.model, c.rows, k == "reuse");
}

}  // namespace

TEST(Linear, EveryEnvironmentByItself) {
  const std::vector<double> k{1, 100, 7}, ground{1, 0.1, 30};
  for (const char* kind : {"direct", "reuse", "cg"}) {
    Chains all(k, ground);
    auto linear = make(kind, all);
    linear->begin_solve(true);
    EnvTable envs(3);
    StepReport report;
    const CurvaturePolicy convex(3);
    EXPECT_EQ(linear->solve(all.system(), {1, 1, 1}, convex, envs, report), (EnvMask{0, 0, 0}));
    for (Index e = 0; e < 3; ++e) {
      EXPECT_LT(all.residual(e), 1e-6) << kind;
      Chains one({k[e]}, {ground[e]});
      auto own = make(kind, one);
      own->begin_solve(true);
      EnvTable env(1);
      own->solve(one.system(), {1}, CurvaturePolicy(1), env, report);
      const auto x = all.x.download(), y = one.x.download();
      for (Index i = 0; i < 4; ++i) EXPECT_EQ(x[4 * e + i], y[i]) << kind << " environment " << e;
    }
  }
}

TEST(Linear, WhatIsNotToDoStandsStill) {
  for (const char* kind : {"direct", "reuse", "cg"}) {
    Chains c({1, 2}, {1, 1});
    auto linear = make(kind, c);
    linear->begin_solve(true);
    EnvTable envs(2);
    StepReport report;
    linear->solve(c.system(), {0, 1}, CurvaturePolicy(2), envs, report);
    EXPECT_EQ(c.x.download()[0], Vec3::Zero()) << kind;
    EXPECT_LT(c.residual(1), 1e-6) << kind;
  }
}

// An indefinite matrix with negative curvature in it is for the curvature policy; a convex one that no shift repairs fails, alone.
TEST(Linear, IndefiniteMatrices) {
  for (const char* kind : {"direct", "cg"}) {
    Chains c({1, 1}, {-5, 1});
    auto linear = make(kind, c);
    linear->begin_solve(true);
    EnvTable envs(2);
    StepReport report;
    CurvaturePolicy exact(2);
    exact.choose(0, 1), exact.choose(1, 1);
    EXPECT_EQ(linear->solve(c.system(), {1, 1}, exact, envs, report), (EnvMask{1, 0})) << kind;
    EXPECT_LT(c.residual(1), 1e-6) << kind;
    linear->solve(c.system(), {1, 1}, CurvaturePolicy(2), envs, report);
    EXPECT_TRUE(envs.is(0, EnvState::failed)) << kind;
    EXPECT_TRUE(envs.is(1, EnvState::running)) << kind;
  }
}

// One chain with forces that move nothing as a whole, solved directly.
struct OnGround {
  explicit OnGround(double ground) : c({1}, {ground}) {
    c.b.upload({Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)});
    auto linear = make("direct", c);
    linear->begin_solve(true);
    linear->solve(c.system(), {1}, CurvaturePolicy(1), envs, report);
  }
  Chains c;
  EnvTable envs{1};
  StepReport report;
};

// A free chain: singular, and a small shift is enough.
TEST(Linear, ASmallShiftMakesWhatNothingHoldsDefinite) {
  OnGround free(0);
  EXPECT_TRUE(free.envs.is(0, EnvState::running));
  EXPECT_LT(free.c.residual(0), 1e-6);
}

// What is softer than nothing by less than that is as good as free.
TEST(Linear, AShiftGrowsUntilAMatrixThatIsHardlyIndefiniteIsDefinite) {
  OnGround soft(-1e-9);
  EXPECT_TRUE(soft.envs.is(0, EnvState::running));
  EXPECT_EQ(soft.report.regularised, 2);
}

TEST(Linear, ReuseKeepsFactorsWithinAStepOnly) {
  Chains c({1}, {1});
  auto linear = make("reuse", c);
  linear->begin_solve(true);
  EnvTable envs(1);
  StepReport report;
  const CurvaturePolicy convex(1);
  EXPECT_FALSE(linear->ready(0));
  linear->solve(c.system(), {1}, convex, envs, report);
  EXPECT_EQ(report.cg, 0) << "the first has a factor of its own";
  EXPECT_TRUE(linear->ready(0));
  linear->solve(c.system(), {1}, convex, envs, report);
  EXPECT_GT(report.cg, 0) << "the second uses it";
  linear->distrust(0);
  EXPECT_FALSE(linear->ready(0));
  linear->solve(c.system(), {1}, convex, envs, report);
  linear->begin_solve(false);
  EXPECT_FALSE(linear->ready(0)) << "another step";
}

// A factor by which conjugate gradients still converge, but in more than half of what a factor costs, is not kept for another iteration.
TEST(Linear, AStaleFactorThatHardlyPaysIsGivenUp) {
  Chains c({0}, {1});
  auto linear = make("reuse", c);
  linear->begin_solve(true);
  EnvTable envs(1);
  StepReport report;
  const CurvaturePolicy convex(1);
  linear->solve(c.system(), {1}, convex, envs, report);
  std::vector<Mat3> other(7, Mat3::Zero());  // six eigenvalues far apart: as many iterations
  for (int i = 0; i < 12; ++i) other[2 * (i / 3)](i % 3, i % 3) = std::pow(4.0, i % 6);
  c.A.value.upload(other);
  linear->solve(c.system(), {1}, convex, envs, report);
  EXPECT_GT(report.cg, tuning::kStaleMost / 2);
  EXPECT_LE(report.cg, tuning::kStaleMost);
  EXPECT_LT(c.residual(0), 1e-2);
  EXPECT_FALSE(linear->ready(0));
}

// A preconditioner that could not be made leaves no factor that a later iteration could take for one.
TEST(Linear, AFailedFactorIsNoFactor) {
  Chains good({2.0}, {1.0}), bad({2.0}, {-50.0});
  const auto linear = make_direct(good.model, good.rows, true);
  linear->begin_solve(true);
  CurvaturePolicy curvature(1);
  EnvTable envs(1);
  StepReport report;
  linear->solve(good.system(), {1}, curvature, envs, report);
  ASSERT_TRUE(linear->ready(0));
  EXPECT_EQ(linear->prepare(bad.system(), {1}), EnvMask{0});
  EXPECT_FALSE(linear->ready(0));
  linear->solve(good.system(), {1}, curvature, envs, report);
  EXPECT_LT(good.residual(0), 1e-12);
}

// Large systems are factored in single precision, which only preconditions, and solved as closely as with any stale factor.
TEST(Linear, LargeFactorsAreRough) {
  model::ModelInput in = toy::boxes(tuning::kDirectBlocks / 4 + 1);
  for (model::BodyInput& body : in.bodies) body.env = 0;
  const model::Model model(in);
  Rows rows;
  rows.number(model, false);
  const Index n = rows.count();
  ASSERT_GT(n, tuning::kDirectBlocks);
  std::vector<std::uint64_t> keys;
  std::vector<Mat3> value;
  for (Index r = 0; r < n; ++r) {
    keys.push_back(linalg::block_key(r, r, n)), value.push_back(2.001 * Mat3::Identity());
    if (r + 1 < n) keys.push_back(linalg::block_key(r, r + 1, n)), value.push_back(-Mat3::Identity());
  }
  linalg::BlockMatrix A;
  linalg::set_pattern(device::Buffer<std::uint64_t>(keys), n, A);
  A.value.upload(value);
  const std::vector<Vec3> rhs(n, Vec3(1, -2, 0.5));
  const device::Buffer<Vec3> b(rhs);
  device::Buffer<Vec3> x(n), y(n);
  const std::vector<double> b2{n * rhs[0].squaredNorm()}, wanted{1e-12};
  const auto linear = make_direct(model, rows, true);
  linear->begin_solve(true);
  EnvTable envs(1);
  StepReport report;
  linear->solve({A, b.view(), x.view(), b2, wanted, model.q.view()}, {1}, CurvaturePolicy(1), envs, report);
  EXPECT_GT(report.cg, 0) << "single precision alone is no solution";
  EXPECT_LE(report.cg, 3);
  EXPECT_TRUE(linear->ready(0));
  linalg::multiply(A, std::as_const(x).view(), y.view());
  const std::vector<Vec3> left = y.download();
  double r2 = 0;
  for (Index r = 0; r < n; ++r) r2 += (left[r] - rhs[r]).squaredNorm();
  EXPECT_LT(std::sqrt(r2 / b2[0]), tuning::kStaleForcing);
}

TEST(Linear, ChoiceGoesByTheLargestEnvironment) {
  const model::Model model(toy::boxes(3));
  Options o;
  EXPECT_EQ(choose_linear(model, o).kind, "direct");
  EXPECT_EQ(choose_linear(model, o).reason.substr(0, 8), "4 blocks");
  o.linear = "cg";
  EXPECT_EQ(choose_linear(model, o).kind, "cg");
}

TEST(Linear, ChoiceGoesBySize) {
  model::Model model(toy::boxes(1));
  const Options o;
  const auto kind = [&](Index blocks) {
    model.env_blocks = {0, blocks};
    return choose_linear(model, o).kind;
  };
  EXPECT_EQ(kind(2000), "direct");
  EXPECT_EQ(kind(2001), "reuse");
  EXPECT_EQ(kind(tuning::kReuseBlocks), "reuse");
  EXPECT_EQ(kind(tuning::kReuseBlocks + 1), "cg");
}

// What is light is solved beside what is heavy: residuals count by what each row's own stiffness makes of them.
TEST(Linear, UnsymmetricSystemsDoNotForgetWhatIsLight) {
  Chains c({0}, {1});
  c.A.value.upload(
      std::vector<Mat3>{1e9 * Mat3::Identity(), Mat3::Zero(), Mat3::Identity(), Mat3::Zero(), Mat3::Identity(), Mat3::Zero(), Mat3::Identity()});
  const std::vector<Vec3> b{Vec3(1e3, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  c.b.upload(b);
  const auto on_host = [](device::View<const Vec3> v) {
    std::vector<Vec3> out(v.n);
    device::copy_out(out.data(), v.p, v.n * sizeof(Vec3));
    return out;
  };
  const auto diagonal = [](std::size_t i) { return i == 0 ? 1e9 : 1.0; };
  const auto whole = [&](const std::vector<Vec3>& x, std::size_t i) -> Vec3 { return diagonal(i) * x[i] + 0.9 * Vec3(1, 1, 1).cross(x[i]); };
  const linalg::Operator J = [&](device::View<const Vec3> in, device::View<Vec3> out) {
    const std::vector<Vec3> x = on_host(in);
    std::vector<Vec3> y;
    for (std::size_t i = 0; i < x.size(); ++i) y.push_back(whole(x, i));
    device::copy_in(out.p, y.data(), y.size() * sizeof(Vec3));
  };
  const linalg::Operator M = [&](device::View<const Vec3> in, device::View<Vec3> out) {
    std::vector<Vec3> x = on_host(in);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] /= diagonal(i);
    device::copy_in(out.p, x.data(), x.size() * sizeof(Vec3));
  };
  LinearSystem s{c.A, std::as_const(c.b).view(), c.x.view(), c.b2, c.wanted, std::as_const(c.q).view(), &J};
  solve_whole(c.model, s, {1}, c.rows.env, {0.01}, 30, M);
  const std::vector<Vec3> x = c.x.download();
  for (std::size_t i = 1; i < 4; ++i) EXPECT_LT((whole(x, i) - b[i]).norm(), 0.02) << i;
}
