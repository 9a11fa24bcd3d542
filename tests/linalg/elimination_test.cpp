#include "linalg/elimination.h"

#include <gtest/gtest.h>

#include "linalg/assembly.h"
#include "problems.h"

using namespace mortise;
using namespace mortise::linalg;
using namespace mortise::linalg::test;

namespace {

constexpr Index kBlocks = 30;

// Blocks that are divisible by three follow up to five others, their neighbour among them; the ninth follows nothing that has a row.
struct Map {
  std::vector<Index> offset{0}, column;
  std::vector<double> weight;
  Index rows = 0;
  Eigen::MatrixXd T;

  explicit Map(std::mt19937& rng) {
    std::vector<Index> row(kBlocks, -1);
    for (Index b = 0; b < kBlocks; ++b)
      if (b % 3 != 0) row[b] = rows++;
    T = Eigen::MatrixXd::Zero(kBlocks, rows);
    std::uniform_real_distribution<double> u(-1, 1);
    for (Index b = 0; b < kBlocks; ++b) {
      std::vector<Index> to;
      if (row[b] >= 0) to = {row[b]};
      if (b % 3 == 0 && b != 9) {
        for (int k = 0; k < 4; ++k) to.push_back(static_cast<Index>(rng() % rows));
        to.push_back(row[(b + 1) % kBlocks]);
        std::sort(to.begin(), to.end());
        to.erase(std::unique(to.begin(), to.end()), to.end());
      }
      for (Index c : to) {
        column.push_back(c);
        weight.push_back(row[b] >= 0 ? 1 : u(rng));
        T(b, c) = weight.back();
      }
      offset.push_back(static_cast<Index>(column.size()));
    }
  }
  Dense wide() const {  // T x I3
    Dense out = Dense::Zero(3 * kBlocks, 3 * rows);
    for (Index b = 0; b < kBlocks; ++b)
      for (Index r = 0; r < rows; ++r) out.block<3, 3>(3 * b, 3 * r) = T(b, r) * Mat3::Identity();
    return out;
  }
};

std::vector<Index> all_rows() {
  std::vector<Index> row(kBlocks);
  for (Index b = 0; b < kBlocks; ++b) row[b] = b;
  return row;
}

void double_pieces(StencilSet& set) {
  const StencilView v = set.view();
  device::parallel_for("test.double", v.hess.n, [=] MORTISE_HD(Index i) { v.hess[i] *= 2; });
}

}  // namespace

TEST(Elimination, IsTheTripleProduct) {
  std::mt19937 rng(3);
  const Map map(rng);
  StencilSet pieces;
  std::vector<StencilSet*> sets{&pieces};
  Assembler assembler;
  assembler.set_rows(Buffer<Index>(all_rows()), kBlocks);
  Elimination elimination;
  elimination.set(map.offset, map.column, map.weight, map.rows);
  BlockMatrix K, A;
  std::uint64_t pattern = 0;
  for (int round = 0; round < 3; ++round) {  // the second time with the same structure, the third with another
    if (round != 1) {
      pieces.resize_uniform(round == 0 ? 60 : 90, 4);
      pieces.need_hessian();
    }
    if (round == 1) {
      double_pieces(pieces);
    } else {
      fill_random(pieces, kBlocks, true, rng);
    }
    assembler.matrix(sets, K);
    elimination.reduce(K, A);
    EXPECT_EQ(A.rows, map.rows);
    EXPECT_EQ(A.pattern == pattern, round == 1);
    pattern = A.pattern;
    const Dense T = map.wide(), want = T.transpose() * dense(K) * T;
    EXPECT_LT((dense(A) - want).norm(), 1e-13 * want.norm()) << round;
    EXPECT_GT(want.norm(), 1);
  }
}

TEST(Elimination, OfNothingKeepsTheBits) {
  std::mt19937 rng(4);
  StencilSet pieces;
  std::vector<StencilSet*> sets{&pieces};
  pieces.resize_uniform(80, 4);
  pieces.need_hessian();
  fill_random(pieces, kBlocks, true, rng);
  Assembler assembler;
  assembler.set_rows(Buffer<Index>(all_rows()), kBlocks);
  BlockMatrix K, A;
  assembler.matrix(sets, K);
  std::vector<Index> offset = all_rows();
  offset.push_back(kBlocks);
  Elimination elimination;
  elimination.set(offset, all_rows(), std::vector<double>(kBlocks, 1.0), kBlocks);
  elimination.reduce(K, A);
  EXPECT_EQ(dense(A), dense(K));
}
