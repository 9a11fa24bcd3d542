#include "linalg/block_matrix.h"

#include <gtest/gtest.h>

#include "linalg/supports.h"
#include "problems.h"

using namespace mortise;
using namespace mortise::linalg;
using namespace mortise::linalg::test;

namespace {

constexpr Index kRows = 50;

void random_matrix(BlockMatrix& A) {
  std::mt19937 rng(11);
  StencilSet set;
  set.resize_uniform(80, 3);
  set.need_hessian();
  fill_random(set, kRows - 1, false, rng);  // the last row has nothing but its diagonal block
  StencilSet* sets[] = {&set};
  Assembler assembler;
  assembler.set_rows(all_rows(kRows), kRows);
  assembler.matrix(sets, A);
}

}  // namespace

TEST(BlockMatrix, StoresEveryDiagonalBlockFirstInItsRow) {
  BlockMatrix A;
  random_matrix(A);
  const auto start = A.row_start.download(), row = A.row.download(), col = A.col.download();
  ASSERT_EQ(static_cast<Index>(start.size()), kRows + 1);
  for (Index r = 0; r < kRows; ++r) {
    ASSERT_LT(start[r], start[r + 1]);
    EXPECT_EQ(col[start[r]], r);
    for (Index k = start[r]; k < start[r + 1]; ++k) {
      EXPECT_EQ(row[k], r);
      if (k > start[r]) {
        EXPECT_LT(col[k - 1], col[k]);
      }
    }
  }
  EXPECT_EQ(A.value.download()[start[kRows - 1]], Mat3(Mat3::Zero()));
}

TEST(BlockMatrix, FullRowsAscend) {
  BlockMatrix A;
  random_matrix(A);
  const auto start = A.full_start.download(), col = A.full_col.download();
  for (Index r = 0; r < kRows; ++r)
    for (Index j = start[r] + 1; j < start[r + 1]; ++j) EXPECT_LT(col[j - 1], col[j]);
}

TEST(BlockMatrix, ProductIsTheDenseOne) {
  BlockMatrix A;
  random_matrix(A);
  const auto x = random_vector(kRows, 2);
  Buffer<Vec3> xb(x), y(kRows);
  multiply(A, xb.view(), y.view());
  EXPECT_LT((dense(y.download()) - dense(A) * dense(x)).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(Supports, ProjectionIsTheDenseOne) {
  BlockMatrix A;
  random_matrix(A);
  std::mt19937 rng(4);
  std::vector<Mat3> P;
  Dense full = Dense::Zero(3 * kRows, 3 * kRows);
  for (const Vec3& v : random_vector(kRows, 8)) {
    const Vec3 n = v.normalized();
    switch (rng() % 4) {
      case 0:
        P.push_back(Mat3::Identity());
        break;
      case 1:
        P.push_back(Mat3::Zero());
        break;
      case 2:
        P.push_back(Mat3::Identity() - n * n.transpose());
        break;
      default:
        P.push_back(n * n.transpose());
    }
    const Index r = static_cast<Index>(P.size()) - 1;
    full.block<3, 3>(3 * r, 3 * r) = P.back();
  }
  const Dense want = full * dense(A) * full + Dense::Identity(3 * kRows, 3 * kRows) - full;
  Buffer<Mat3> Pb(P);
  project(A, Pb.view());
  EXPECT_LT((dense(A) - want).cwiseAbs().maxCoeff(), 1e-13);
}
