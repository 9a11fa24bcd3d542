#include "linalg/cg.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "linalg/direct.h"
#include "linalg/env_sums.h"
#include "linalg/jacobi.h"
#include "problems.h"

using namespace mortise;
using namespace mortise::linalg;
using namespace mortise::linalg::test;

namespace {

CgResult conjugate_gradients(const BlockMatrix& A, View<const Vec3> b, View<Vec3> x, const std::vector<Index>& env_rows,
                             const std::vector<double>& relative, const CgOptions& options = {}) {
  BlockJacobi M(env_rows);
  M.build(A);
  return ConjugateGradients(env_rows).solve(A, M, b, x, relative, options);
}

// Cubes of different size and stiffness as environments of one block diagonal matrix.
struct Batch {
  std::vector<std::unique_ptr<Cube>> cubes;
  std::vector<Index> env_rows{0};
  BlockMatrix A;
  Buffer<Vec3> b;

  explicit Batch(const std::vector<Index>& cells) {
    std::vector<StencilSet*> sets;
    std::vector<Vec3> rhs;
    for (Index c : cells) {
      cubes.push_back(std::make_unique<Cube>(c, 10.0 * c, env_rows.back(), 1e6 / c));
      sets.push_back(&cubes.back()->elastic), sets.push_back(&cubes.back()->ground);
      env_rows.push_back(env_rows.back() + cubes.back()->nodes);
      for (const Vec3& v : random_vector(cubes.back()->nodes, c)) rhs.push_back(v);
    }
    Assembler assembler;
    assembler.set_rows(all_rows(env_rows.back()), env_rows.back());
    assembler.matrix(sets, A);
    b.upload(rhs);
  }
  std::vector<double> tolerance(double relative) const { return std::vector<double>(cubes.size(), relative); }
  CgResult solve(Buffer<Vec3>& x, double relative) {
    x.resize(A.rows);
    x.zero();
    return conjugate_gradients(A, b.view(), x.view(), env_rows, tolerance(relative));
  }
};

}  // namespace

TEST(EnvSums, AreTheSumsOfEveryEnvironment) {
  const std::vector<Index> offset{0, 3, 3, 5000, 5064};  // the second is empty
  EnvSums sums(offset);
  const View<const Vec2> s = sums("test", [=] MORTISE_HD(Index i) { return Vec2(i, 1); });
  ASSERT_EQ(s.n, 4);
  const auto got = read(s);
  for (Index e = 0; e < 4; ++e) {
    const double n = offset[e + 1] - offset[e];
    EXPECT_EQ(got[e][1], n);
    EXPECT_EQ(got[e][0], n * (offset[e] + offset[e + 1] - 1) / 2);
  }
}

TEST(Cg, AgreesWithTheDirectSolution) {
  Batch batch({8});
  Buffer<Vec3> x, want(batch.A.rows);
  const CgResult r = batch.solve(x, 1e-12);
  ASSERT_TRUE(r.converged());
  DirectSolver direct;
  ASSERT_TRUE(direct.factor(batch.A));
  direct.solve(batch.b.view(), want.view());
  const DenseVector w = dense(want.download());
  EXPECT_LT((dense(x.download()) - w).norm(), 1e-8 * w.norm());
  EXPECT_GT(r.iterations(), 10);
}

TEST(Cg, ReportsTheTrueResidual) {
  Batch batch({3, 5});
  Buffer<Vec3> x;
  const CgResult r = batch.solve(x, 1e-6);
  const DenseVector b = dense(batch.b.download()), residual = b - dense(batch.A) * dense(x.download());
  for (Index e = 0; e < 2; ++e) {
    const Index first = 3 * batch.env_rows[e], n = 3 * batch.env_rows[e + 1] - first;
    EXPECT_EQ(r.env[e].end, CgEnd::converged);
    EXPECT_NEAR(r.env[e].residual, residual.segment(first, n).norm(), 1e-12 * r.env[e].rhs);
    EXPECT_NEAR(r.env[e].rhs, b.segment(first, n).norm(), 1e-12 * r.env[e].rhs);
    EXPECT_LE(r.env[e].residual, 1e-6 * r.env[e].rhs);
  }
}

TEST(Cg, EnvironmentsDoNotFeelTheirNeighbours) {
  Batch both({6, 3, 5});
  Buffer<Vec3> x;
  const CgResult r = both.solve(x, 1e-9);
  const auto all = x.download();
  const std::vector<Index> cells{6, 3, 5};
  for (Index e = 0; e < 3; ++e) {
    Batch one({cells[e]});
    Buffer<Vec3> alone;
    const CgResult s = one.solve(alone, 1e-9);
    EXPECT_EQ(s.env[0].iterations, r.env[e].iterations);
    EXPECT_EQ(s.env[0].residual, r.env[e].residual);
    EXPECT_EQ(alone.download(), std::vector<Vec3>(all.begin() + both.env_rows[e], all.begin() + both.env_rows[e + 1]));
  }
  EXPECT_NE(r.env[0].iterations, r.env[1].iterations);
}

TEST(Cg, BitsDoNotDependOnThreads) {
  std::vector<Vec3> first;
  for (int threads : {1, 2}) {
    device::set_threads(threads);
    Batch batch({7, 4});
    Buffer<Vec3> x;
    EXPECT_TRUE(batch.solve(x, 1e-8).converged());
    if (threads == 1) first = x.download();
    EXPECT_EQ(x.download(), first);
  }
  device::set_threads(0);
}

TEST(Cg, EveryEnvironmentHasItsOwnTolerance) {
  Batch batch({5, 5});
  Buffer<Vec3> x(batch.A.rows);
  x.zero();
  const CgResult r = conjugate_gradients(batch.A, batch.b.view(), x.view(), batch.env_rows, {1e-2, 1e-10});
  EXPECT_TRUE(r.converged());
  EXPECT_LT(2 * r.env[0].iterations, r.env[1].iterations);
  EXPECT_GT(r.env[0].residual, 1e-6 * r.env[0].rhs) << "frozen once converged";
}

TEST(Cg, StartsFromTheGivenVector) {
  Batch batch({5});
  Buffer<Vec3> x;
  ASSERT_TRUE(batch.solve(x, 1e-10).converged());
  const auto solution = x.download();
  const CgResult again = conjugate_gradients(batch.A, batch.b.view(), x.view(), batch.env_rows, {1e-9});
  EXPECT_TRUE(again.converged());
  EXPECT_EQ(again.env[0].iterations, 0);
  EXPECT_EQ(x.download(), solution);
}

TEST(Cg, ZeroRightHandSide) {
  Batch batch({2, 3});
  auto b = batch.b.download();
  std::fill(b.begin(), b.begin() + batch.env_rows[1], Vec3::Zero());
  batch.b.upload(b);
  Buffer<Vec3> x;
  const CgResult r = batch.solve(x, 1e-8);
  EXPECT_TRUE(r.converged());
  EXPECT_EQ(r.env[0].iterations, 0);
  EXPECT_GT(r.env[1].iterations, 0);
  EXPECT_EQ(x.download()[0], Vec3(Vec3::Zero()));
}

TEST(Cg, DetectsNegativeCurvatureInOneEnvironment) {
  Batch batch({3, 4});
  // Strong negative coupling off the diagonal of environment 0: its diagonal blocks stay positive definite.
  auto value = batch.A.value.download();
  value[batch.A.row_start.download()[0] + 1] -= 1e8 * Mat3::Identity();
  batch.A.value.upload(value);
  Buffer<Vec3> x;
  const CgResult r = batch.solve(x, 1e-8);
  EXPECT_EQ(r.env[0].end, CgEnd::not_positive_definite);
  EXPECT_EQ(r.env[1].end, CgEnd::converged);
  for (const Vec3& v : x.download()) EXPECT_TRUE(v.allFinite());
}

TEST(Cg, DetectsABadDiagonalBlock) {
  Batch batch({3, 4});
  for (const Mat3& bad : {Mat3(Mat3::Zero()), Mat3(-Mat3::Identity()), Mat3(Mat3::Constant(std::nan("")))}) {
    auto value = batch.A.value.download();
    value[batch.A.row_start.download()[5]] = bad;
    batch.A.value.upload(value);
    Buffer<Vec3> x;
    const CgResult r = batch.solve(x, 1e-8);
    EXPECT_EQ(r.env[0].end, CgEnd::not_positive_definite);
    EXPECT_EQ(r.env[0].iterations, 0);
    EXPECT_TRUE(x.download()[5].isZero());
    EXPECT_EQ(r.env[1].end, CgEnd::converged);
  }
}

TEST(Cg, StopsAtTheIterationLimit) {
  Batch batch({6});
  Buffer<Vec3> x(batch.A.rows);
  x.zero();
  CgOptions options;
  options.max_iterations = 5;
  const CgResult r = conjugate_gradients(batch.A, batch.b.view(), x.view(), batch.env_rows, {1e-10}, options);
  EXPECT_EQ(r.env[0].end, CgEnd::iteration_limit);
  EXPECT_EQ(r.env[0].iterations, 5);
}

TEST(Cg, DoesNotBelieveTheRecurrenceBelowRounding) {
  Batch batch({6});
  Buffer<Vec3> x;
  const CgResult r = batch.solve(x, 1e-30);
  EXPECT_EQ(r.env[0].end, CgEnd::stagnated);
  EXPECT_GT(r.env[0].restarts, 0);
  EXPECT_LT(r.env[0].residual, 1e-10 * r.env[0].rhs) << "the true residual at exit";
  EXPECT_GT(r.env[0].residual, 1e-30 * r.env[0].rhs);
}

TEST(Cg, ReportsTheTrueResidualAtTheLimitToo) {
  Batch batch({4});
  Buffer<Vec3> x(batch.A.rows);
  x.zero();
  CgOptions options;
  options.max_iterations = 500;  // the recurrence is far below rounding by then
  const CgResult r = conjugate_gradients(batch.A, batch.b.view(), x.view(), batch.env_rows, {1e-140}, options);
  EXPECT_EQ(r.env[0].end, CgEnd::iteration_limit);
  EXPECT_GT(r.env[0].residual, 1e-17 * r.env[0].rhs);
  EXPECT_LT(r.env[0].residual, 1e-10 * r.env[0].rhs);
}

TEST(Cg, AbsoluteToleranceEndsEarly) {
  Batch batch({6});
  Buffer<Vec3> x(batch.A.rows);
  x.zero();
  CgOptions options;
  options.absolute = {0.1};
  const CgResult r = conjugate_gradients(batch.A, batch.b.view(), x.view(), batch.env_rows, {1e-12}, options);
  EXPECT_EQ(r.env[0].end, CgEnd::converged);
  EXPECT_LE(r.env[0].residual, 0.1);
  EXPECT_GT(r.env[0].residual, 1e-3);
}

// The recorded iterations are replayed in blocks; where a block ends must not show.
TEST(Cg, BitsDoNotDependOnTheLengthOfBlocks) {
  Batch batch({6, 3, 5});
  BlockJacobi M(batch.env_rows);
  M.build(batch.A);
  std::vector<Vec3> first;
  for (Index every : {1, 7, 16, 1000}) {
    Buffer<Vec3> x(batch.A.rows);
    x.zero();
    CgOptions options;
    options.check_every = every;
    const CgResult r = ConjugateGradients(batch.env_rows).solve(batch.A, M, batch.b.view(), x.view(), batch.tolerance(1e-9), options);
    EXPECT_TRUE(r.converged());
    if (first.empty()) first = x.download();
    EXPECT_EQ(x.download(), first) << every;
  }
}

// Convergence is looked into before the host asks, where it was reached last time.
TEST(Cg, TheHostLooksOnceWhereABlockIsEnough) {
  Batch batch({4});
  BlockJacobi M(batch.env_rows);
  M.build(batch.A);
  ConjugateGradients solver(batch.env_rows);
  for (Index every : {1000, 7}) {
    Buffer<Vec3> x(batch.A.rows);
    x.zero();
    CgOptions options;
    options.check_every = every;
    const long long before = device::transfers().to_host;
    const CgResult r = solver.solve(batch.A, M, batch.b.view(), x.view(), batch.tolerance(1e-9), options);
    EXPECT_TRUE(r.converged());
    const Index blocks = (r.iterations() + every - 1) / every;
    EXPECT_EQ(device::transfers().to_host - before, blocks) << every;
  }
}

// Where it is known about how long it will take, the host does not look before; the bits are those of a solve that is looked at.
TEST(Cg, TheHostLooksWhenTheEndIsNear) {
  Batch batch({6, 3, 5});
  BlockJacobi M(batch.env_rows);
  M.build(batch.A);
  ConjugateGradients solver(batch.env_rows);
  CgOptions options;
  options.check_every = 2;
  std::vector<Vec3> first;
  Index taken = 0;
  for (const bool known : {false, true}) {
    Buffer<Vec3> x(batch.A.rows);
    x.zero();
    options.expected = taken;
    const long long before = device::transfers().to_host;
    const CgResult r = solver.solve(batch.A, M, batch.b.view(), x.view(), batch.tolerance(1e-9), options);
    EXPECT_TRUE(r.converged());
    const long long looks = device::transfers().to_host - before;
    taken = r.iterations();
    ASSERT_GT(taken, 20);
    if (!known) {
      EXPECT_GE(looks, taken / 2);
      first = x.download();
    } else {
      EXPECT_LE(looks, 4 + taken / 4);  // none before half of them
      EXPECT_EQ(x.download(), first);
    }
  }
}

// One solver for matrices whose values, structure and right-hand side change.
TEST(Cg, SolverIsUsedAgain) {
  Batch a({4, 3}), b({3, 4});
  ConjugateGradients solver(a.env_rows);
  BlockJacobi M(a.env_rows);
  const auto solve = [&](Batch& batch, ConjugateGradients& cg) {
    M.build(batch.A);
    Buffer<Vec3> x(batch.A.rows);
    x.zero();
    EXPECT_TRUE(cg.solve(batch.A, M, batch.b.view(), x.view(), batch.tolerance(1e-9)).converged());
    return x.download();
  };
  const auto first = solve(a, solver);
  auto value = a.A.value.download();
  for (Mat3& v : value) v *= 4;  // in the same memory
  a.A.value.upload(value);
  const auto scaled = solve(a, solver);
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_LT((4 * scaled[i] - first[i]).norm(), 1e-7 * first[i].norm());
  Batch c({4, 3});
  EXPECT_EQ(solve(c, solver), first) << "another matrix of the same values";
  Buffer<Vec3> wrong(1);
  EXPECT_THROW(solver.solve(b.A, M, b.b.view(), wrong.view(), b.tolerance(1e-9)), Error);
}
