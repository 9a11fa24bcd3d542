#include "linalg/scalar_csr.h"

#include <gtest/gtest.h>

#include "problems.h"

using namespace mortise;
using namespace mortise::linalg;
using namespace mortise::linalg::test;

TEST(ScalarCsr, IsThePermutedMatrix) {
  Cube cube(2, 10.0);
  BlockMatrix A;
  cube_matrix(cube, A);
  auto blocks = A.value.download();
  std::mt19937 rng(1);
  for (Mat3& v : blocks) v += 0.1 * Mat3::Random();
  const auto row = A.row.download(), column = A.col.download();
  for (std::size_t k = 0; k < blocks.size(); ++k)
    if (row[k] == column[k]) blocks[k] = (blocks[k] + blocks[k].transpose()).eval();
  A.value.upload(blocks);
  std::vector<int> order(A.rows);
  for (Index i = 0; i < A.rows; ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), rng);

  ScalarCsr csr;
  csr.set_pattern(A, order);
  csr.set_values(A);
  ASSERT_EQ(csr.rows(), 3 * A.rows);
  const Dense want = dense(A);
  Dense got = Dense::Zero(csr.rows(), csr.rows());
  const auto start = csr.row_start().download(), col = csr.col().download();
  const auto value = csr.value().download();
  for (Index i = 0; i < csr.rows(); ++i)
    for (Index k = start[i]; k < start[i + 1]; ++k) {
      EXPECT_TRUE(k == start[i] || col[k - 1] < col[k]) << "ascending";
      got(3 * order[i / 3] + i % 3, 3 * order[col[k] / 3] + col[k] % 3) = value[k];
    }
  EXPECT_EQ(got, want);

  const auto v = random_vector(A.rows, 2);
  const Buffer<Vec3> in(v);
  Buffer<double> there(csr.rows());
  Buffer<Vec3> back(A.rows);
  csr.to(in.view(), there.view());
  EXPECT_EQ(there.download()[0], v[order[0]][0]);
  csr.from(std::as_const(there).view(), back.view());
  EXPECT_EQ(back.download(), v);
}
