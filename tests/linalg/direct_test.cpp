#include "linalg/direct.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "linalg/stale_factor.h"
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
  solver.solve(bb.view(), x.view());
  EXPECT_LT(relative_residual(A, b, x.download()), 1e-12);
  const DenseVector want = dense(A).llt().solve(dense(b));
  EXPECT_LT((dense(x.download()) - want).norm(), 1e-10 * want.norm());
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

TEST(Direct, RoughFactorsArePreconditioners) {
  Cube cube(6, 1e3);
  BlockMatrix A;
  cube_matrix(cube, A);
  const auto b = random_vector(A.rows, 1);
  Buffer<Vec3> bb(b), x(A.rows);
  DirectSolver solver;
  ASSERT_TRUE(solver.factor(A, Precision::rough));
  EXPECT_EQ(solver.precision(), Precision::rough);
  solver.solve(bb.view(), x.view());
  const double error = relative_residual(A, b, x.download());
  EXPECT_LT(error, 1e-2);
  EXPECT_GT(error, 1e-9) << "single precision is not that good";
  const StaleResult cg = solve_with_stale_factor(A, solver, bb.view(), x.view(), 1e-12, 10);
  EXPECT_TRUE(cg.converged);
  EXPECT_LT(relative_residual(A, b, x.download()), 1e-11);
  ASSERT_TRUE(solver.factor(A, Precision::trial));
  EXPECT_EQ(solver.precision(), Precision::rough);
  ASSERT_TRUE(solver.factor(A));
  EXPECT_EQ(solver.precision(), Precision::full);
  solver.solve(bb.view(), x.view());
  EXPECT_LT(relative_residual(A, b, x.download()), 1e-12);
}

TEST(Direct, WhatIsTooIllConditionedForSinglePrecisionIsFactoredInDouble) {
  Cube cube(4, 1e-5);  // condition about 1e11
  BlockMatrix A;
  cube_matrix(cube, A);
  DirectSolver solver;
  EXPECT_FALSE(solver.factor(A, Precision::trial));
  ASSERT_TRUE(solver.factor(A, Precision::rough));
  EXPECT_EQ(solver.precision(), Precision::full);
}

// The order of elimination outlives small changes of the pattern, until it is no good any more or taken away: then it is that of the present pattern,
// as for a solver that never knew another.
TEST(Direct, KeepsTheOrderUntilOutgrown) {
  Cube cube(8, 1e3);
  const auto b = random_vector(cube.nodes, 1);
  const Buffer<Vec3> bb(b);
  const auto with_link_from_first_to = [&](Index last, BlockMatrix& out) {
    StencilSet link;
    link.resize_uniform(1, 2);
    link.need_hessian();
    write(link.view().block, std::vector<Index>{0, last});
    write(link.view().hess, std::vector<Mat3>{1e5 * Mat3::Identity(), -1e5 * Mat3::Identity(), 1e5 * Mat3::Identity()});
    link.pattern_changed();
    Assembler assembler;
    assembler.set_rows(all_rows(cube.nodes), cube.nodes);
    StencilSet* sets[] = {&cube.elastic, &cube.ground, &link};
    assembler.matrix(sets, out);
  };
  const auto solution = [&](DirectSolver& solver, const BlockMatrix& matrix) {
    Buffer<Vec3> x(matrix.rows);
    EXPECT_TRUE(solver.factor(matrix));
    solver.solve(bb.view(), x.view());
    EXPECT_LT(relative_residual(matrix, b, x.download()), 1e-12);
    return x.download();
  };
  BlockMatrix A, near;
  cube_matrix(cube, A);
  with_link_from_first_to(101, near);
  DirectSolver alone, before;
  const auto fresh = solution(alone, near);
  solution(before, A);
  const auto kept = solution(before, near);
  EXPECT_NE(kept, fresh) << "in A's order";
  EXPECT_EQ(before.stats().orderings, 1);
  const DirectSolver::Order order = before.order();
  before.set_order({});
  EXPECT_EQ(solution(before, near), fresh);
  EXPECT_EQ(before.stats().orderings, 2);
  DirectSolver other;
  other.set_order(order);
  EXPECT_EQ(solution(other, near), kept) << "the order is all that it kept";
  EXPECT_EQ(other.stats().orderings, 0);
  DirectSolver far_outgrown;
  far_outgrown.set_order({order.rows, 0.5 * order.flops});
  EXPECT_EQ(solution(far_outgrown, near), fresh);
  EXPECT_EQ(far_outgrown.stats().orderings, 1);
  // Outgrown by less, it serves while a new one is found, which is taken where it is asked for, or at the next pattern.
  for (const bool asked : {true, false}) {
    DirectSolver outgrown;
    outgrown.set_order({order.rows, 0.8 * order.flops});
    EXPECT_EQ(solution(outgrown, near), kept);
    EXPECT_EQ(outgrown.stats().orderings, 0);
    if (asked)
      outgrown.settle_order();
    else
      solution(outgrown, A);
    EXPECT_EQ(outgrown.stats().orderings, 1);
    EXPECT_EQ(solution(outgrown, near), fresh);
    EXPECT_EQ(outgrown.stats().orderings, 1) << "which is good for it";
  }
  // Nobody waits for what nobody wants any more.
  DirectSolver given_up;
  given_up.set_order({order.rows, 0.8 * order.flops});
  solution(given_up, near);
  given_up.set_order(order);
  EXPECT_EQ(solution(given_up, near), kept);
  EXPECT_EQ(given_up.stats().orderings, 0);
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
    solver.solve(x.view(), x.view());
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
  solver.solve(none.view(), none.view());
}
