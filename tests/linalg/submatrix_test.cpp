#include "linalg/submatrix.h"

#include "linalg/cg.h"
#include "linalg/jacobi.h"
#include "linalg/per_environment.h"
#include "problems.h"

using namespace mortise;
using namespace mortise::linalg;
using namespace mortise::linalg::test;

namespace {

// Two chains of three and of five rows; the second has an edge more where `more`.
BlockMatrix chains(bool more) {
  BlockMatrix A;
  std::vector<std::uint64_t> keys;
  std::vector<Mat3> value;
  const auto put = [&](Index r, Index c, double v) { keys.push_back(block_key(r, c, 8)), value.push_back(v * Mat3::Identity()); };
  for (Index r = 0; r < 8; ++r) {
    put(r, r, 4 + r);
    if (r != 2 && r != 7) put(r, r + 1, -1 - 0.1 * r);
    if (more && r == 3) put(3, 6, -0.5);
  }
  set_pattern(Buffer<std::uint64_t>(keys), 8, A);
  A.value.upload(value);
  return A;
}

}  // namespace

TEST(SubMatrix, IsThePartOfABlockDiagonalMatrix) {
  const BlockMatrix A = chains(false);
  const std::vector<Vec3> x = random_vector(8, 1);
  Buffer<Vec3> whole(8), part(5);
  multiply(A, Buffer<Vec3>(x).view(), whole.view());
  SubMatrix sub;
  BlockMatrix& B = sub.of(A, 3, 8);
  EXPECT_EQ(B.rows, 5);
  multiply(B, Buffer<Vec3>(std::vector<Vec3>(x.begin() + 3, x.end())).view(), part.view());
  const auto a = whole.download(), b = part.download();
  for (Index r = 0; r < 5; ++r) EXPECT_EQ(a[3 + r], b[r]);
}

// A new structure elsewhere costs no new analysis here.
TEST(SubMatrix, PatternStaysWhileItsOwnRowsDo) {
  SubMatrix first, second;
  const BlockMatrix A = chains(false), B = chains(true);
  const std::uint64_t one = first.of(A, 0, 3).pattern, two = second.of(A, 3, 8).pattern;
  EXPECT_EQ(first.of(B, 0, 3).pattern, one);
  EXPECT_NE(second.of(B, 3, 8).pattern, two);
}

// Only chosen environments are built anew, and those that are not solved stand still.
TEST(PerEnvironment, BuildsWhatIsChosen) {
  const std::vector<Index> rows{0, 3, 8};
  std::vector<std::unique_ptr<Preconditioner>> all;
  all.push_back(std::make_unique<BlockJacobi>(rows));
  all.push_back(std::make_unique<PerEnvironment>(rows, [](Index first, Index last) {
    return std::make_unique<BlockJacobi>(std::vector<Index>{0, last - first});
  }));
  for (const auto& M : all) {
    BlockMatrix A = chains(false);
    const Buffer<Vec3> place(8), r(random_vector(8, 2));
    M->build(A, place.view());
    Buffer<Vec3> z(8), again(8);
    M->apply(r.view(), z.view());
    std::vector<Mat3> value = A.value.download();
    for (Mat3& v : value) v *= 2;
    A.value.upload(value);
    M->choose({0, 1});
    M->build(A, place.view());
    M->apply(r.view(), again.view());
    const auto a = z.download(), b = again.download();
    for (Index i = 0; i < 8; ++i) EXPECT_LT((b[i] - (i < 3 ? 1.0 : 0.5) * a[i]).norm(), 1e-15) << i;
  }
}

TEST(Cg, OnlyWhatIsAskedFor) {
  const BlockMatrix A = chains(false);
  BlockJacobi M({0, 3, 8});
  M.build(A);
  ConjugateGradients cg({0, 3, 8});
  const Buffer<Vec3> b(random_vector(8, 3));
  Buffer<Vec3> x(8);
  x.zero();
  CgOptions options;
  options.only = {0, 1};
  const CgResult r = cg.solve(A, M, b.view(), x.view(), {1e-10, 1e-10}, options);
  EXPECT_GT(r.env[1].iterations, 0);
  const auto out = x.download();
  for (Index i = 0; i < 3; ++i) EXPECT_EQ(out[i], Vec3::Zero());
  EXPECT_GT(out[4].norm(), 0);
}
