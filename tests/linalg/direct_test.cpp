#include "linalg/direct.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "problems.h"

using namespace mortise;
using namespace mortise::linalg;
using namespace mortise::linalg::test;

namespace {

double relative_residual(const BlockMatrix& A, const std::vector<Vec3>& b, const std::vector<Vec3>& x) {
  return (dense(b) - dense(A) * dense(x)).norm() / dense(b).norm();
}

void scale(BlockMatrix& A, double factor) {
  auto value = A.value.download();
  for (Mat3& v : value) v *= factor;
  A.value.upload(value);
}

}  // namespace

TEST(Direct, SolvesToRoundingAndAgreesWithDense) {
  Cube cube(4, 1e3);
  BlockMatrix A;
  cube_matrix(cube, A);
  const auto b = random_vector(A.rows, 1);
  Buffer<Vec3> bb(b), x(A.rows);
  DirectSolver solver;
  ASSERT_TRUE(solver.factor(A));
  EXPECT_EQ(solver.solve(bb.view(), x.view()), -1);
  EXPECT_LT(relative_residual(A, b, x.download()), 1e-12);
  const DenseVector want = dense(A).llt().solve(dense(b));
  EXPECT_LT((dense(x.download()) - want).norm(), 1e-10 * want.norm());
  EXPECT_EQ(solver.stats().ordering, "metis");
  EXPECT_GE(solver.stats().factor_entries, 9.0 * A.upper_blocks() - 3.0 * A.rows);
  EXPECT_GT(solver.stats().factor_flops, solver.stats().factor_entries);
}

TEST(Direct, AnalysesOncePerPattern) {
  Cube cube(3, 1e3);
  BlockMatrix A;
  cube_matrix(cube, A);
  const auto b = random_vector(A.rows, 1);
  Buffer<Vec3> bb(b), x(A.rows);
  DirectSolver solver;
  for (double factor : {1.0, 2.0, 0.125}) {  // changed values
    scale(A, factor);
    ASSERT_TRUE(solver.factor(A));
    solver.solve(bb.view(), x.view());
    EXPECT_LT(relative_residual(A, b, x.download()), 1e-12);
  }
  EXPECT_EQ(solver.stats().analyses, 1);
  Cube larger(4, 1e3);  // changed structure
  BlockMatrix B;
  cube_matrix(larger, B);
  const auto c = random_vector(B.rows, 1);
  Buffer<Vec3> cb(c), y(B.rows);
  ASSERT_TRUE(solver.factor(B));
  solver.solve(cb.view(), y.view());
  EXPECT_LT(relative_residual(B, c, y.download()), 1e-12);
  EXPECT_EQ(solver.stats().analyses, 2);
  EXPECT_EQ(solver.stats().factorisations, 4);
}

// Cholesky leaves a residual near rounding; steps in the wrong direction or from a wrong residual would multiply it.
TEST(Direct, RefinementKeepsTheResidualAtRounding) {
  Cube cube(4, 1e-2);  // nearly free: condition about 1e8
  BlockMatrix A;
  cube_matrix(cube, A);
  const auto b = random_vector(A.rows, 1);
  Buffer<Vec3> bb(b), plain(A.rows);
  DirectSolver solver;
  ASSERT_TRUE(solver.factor(A));
  solver.solve(bb.view(), plain.view());
  const double reported = solver.solve(bb.view(), bb.view(), 6);  // in place
  const double refined = relative_residual(A, b, bb.download());
  EXPECT_LT(refined, 2 * relative_residual(A, b, plain.download()));
  EXPECT_LT(refined, 1e-8);
  EXPECT_LT(reported, 3 * refined);
  EXPECT_GT(reported, refined / 3);
}

TEST(Direct, ReportsAMatrixThatIsNotPositiveDefinite) {
  Cube cube(2, 1e3);
  BlockMatrix A;
  cube_matrix(cube, A);
  auto value = A.value.download();
  const Index bad = 13;
  value[A.row_start.download()[bad]](1, 1) = -1e9;
  A.value.upload(value);
  DirectSolver solver;
  EXPECT_FALSE(solver.factor(A));
  EXPECT_EQ(solver.failed_row(), bad);
  Buffer<Vec3> b(random_vector(A.rows, 1));
  EXPECT_THROW(solver.solve(b.view(), b.view()), Error);
  cube_matrix(cube, A);
  EXPECT_TRUE(solver.factor(A)) << "usable again afterwards";
}

TEST(Direct, RefusesNan) {
  Cube cube(2, 1e3);
  BlockMatrix A;
  cube_matrix(cube, A);
  auto value = A.value.download();
  value[7](0, 0) = std::nan("");
  A.value.upload(value);
  DirectSolver solver;
  EXPECT_FALSE(solver.factor(A));
}

TEST(Direct, OrderingReducesFill) {
  const Index cells = 12, side = cells + 1;
  Cube cube(cells, 1e3);
  BlockMatrix A;
  cube_matrix(cube, A);
  DirectSolver solver;
  ASSERT_TRUE(solver.factor(A));
  const double banded = 9.0 * A.rows * side * side;  // fill of the natural order: one layer of nodes in every column
  EXPECT_LT(solver.stats().factor_entries, 0.6 * banded);
}

TEST(Direct, BitsDoNotDependOnThreads) {
  std::vector<Vec3> first;
  for (int threads : {1, 2}) {
    device::set_threads(threads);
    Cube cube(12, 1e3);
    BlockMatrix A;
    cube_matrix(cube, A);
    Buffer<Vec3> x(random_vector(A.rows, 1));
    DirectSolver solver;
    ASSERT_TRUE(solver.factor(A));
    solver.solve(x.view(), x.view(), 1);
    if (threads == 1) first = x.download();
    EXPECT_EQ(x.download(), first);
  }
  device::set_threads(0);
}

TEST(Direct, NoRows) {
  BlockMatrix A;
  Assembler assembler;
  assembler.set_rows(Buffer<Index>(), 0);
  assembler.matrix({}, A);
  DirectSolver solver;
  EXPECT_TRUE(solver.factor(A));
  Buffer<Vec3> none;
  EXPECT_EQ(solver.solve(none.view(), none.view()), -1);
}
