#include "linalg/rank_ones.h"

#include "problems.h"

using namespace mortise;
using namespace mortise::linalg;
using namespace mortise::linalg::test;

// Two stencils of two and three blocks, one of them unused, rank 2, against the dense sum; the transposed product against the transpose.
TEST(RankOnes, ProductsAreThoseOfTheSum) {
  const std::vector<Index> counts{2, 3, 0}, block{1, 3, 0, -1, 1};
  const Index slots = 5, rank = 2, rows = 4;
  StencilSet set;
  set.resize(Buffer<Index>(counts));
  write(set.view().block, block);
  RankOnes pieces;
  pieces.resize(rank, slots);
  std::vector<Vec3> l = random_vector(rank * slots, 1), r = random_vector(rank * slots, 2);
  write(pieces.left.view(), l), write(pieces.right.view(), r);
  Dense J = Dense::Zero(3 * rows, 3 * rows);
  const std::vector<std::pair<int, int>> stencils{{0, 2}, {2, 5}};
  for (const auto& [begin, end] : stencils)
    for (Index c = 0; c < rank; ++c)
      for (int a = begin; a < end; ++a)
        for (int b = begin; b < end; ++b)
          if (block[a] >= 0 && block[b] >= 0) J.block<3, 3>(3 * block[a], 3 * block[b]) += l[c * slots + a] * r[c * slots + b].transpose();
  const std::vector<Vec3> d = random_vector(rows, 3);
  const Buffer<Vec3> in(d);
  for (const bool transposed : {false, true}) {
    multiply(pieces, transposed, in.view(), set);
    const std::vector<Vec3> piece = read(View<const Vec3>(set.view().grad));
    DenseVector y = DenseVector::Zero(3 * rows);
    for (Index k = 0; k < slots; ++k)
      if (block[k] >= 0) y.segment<3>(3 * block[k]) += piece[k];
    const DenseVector want = (transposed ? Dense(J.transpose()) : J) * dense(d);
    EXPECT_LT((y - want).norm(), 1e-14 * want.norm()) << transposed;
  }
}
