#include "linalg/assembly.h"

#include <gtest/gtest.h>

#include "problems.h"

using namespace mortise;
using namespace mortise::linalg;
using namespace mortise::linalg::test;

namespace {

constexpr Index kBlocks = 40;

// Every fifth block has no row; rows are numbered against the block order, so that pairs need transposing.
std::vector<Index> rows_backwards(Index& rows) {
  std::vector<Index> row(kBlocks, -1);
  rows = 0;
  for (Index b = kBlocks; b-- > 0;)
    if (b % 5 != 0) row[b] = rows++;
  return row;
}

struct OnRowsBackwards {
  Index rows = 0;
  std::vector<Index> row = rows_backwards(rows);
  Assembler assembler;
  BlockMatrix A;

  OnRowsBackwards() { assembler.set_rows(Buffer<Index>(row), rows); }
};

struct Random {
  StencilSet tets, contact;
  std::vector<StencilSet*> sets{&tets, &contact};
  std::mt19937 rng{5};

  Random() {
    tets.resize_uniform(100, 4);
    tets.need_hessian();
    fill_random(tets, kBlocks, false, rng);
    new_contact();
  }
  void new_contact(Index n = 60, Index blocks = kBlocks) {
    std::vector<Index> counts(n + 1);
    for (Index& c : counts) c = static_cast<Index>(rng() % 9);
    contact.resize(Buffer<Index>(counts));
    contact.need_hessian();
    fill_random(contact, blocks, true, rng);
  }
};

void expect_dense_sum(Assembler& assembler, Random& problem, const std::vector<Index>& row, Index rows, BlockMatrix& A) {
  Buffer<Vec3> g;
  assembler.matrix(problem.sets, A);
  assembler.gradient(problem.sets, kBlocks, g);
  DenseVector want_g = DenseVector::Zero(3 * kBlocks);
  Dense want = Dense::Zero(3 * rows, 3 * rows);
  for (StencilSet* set : problem.sets) add_dense(*set, row, want_g, want);
  EXPECT_LT((dense(A) - want).norm(), 1e-12);
  EXPECT_LT((dense(g.download()) - want_g).norm(), 1e-12);
}

}  // namespace

TEST(Assembly, RandomStencilsSumLikeDenseMatrices) {
  Random problem;
  auto [rows, row, assembler, A] = OnRowsBackwards();
  expect_dense_sum(assembler, problem, row, rows, A);
}

// Of environments that are left out nothing is summed: forces stay as they were, the matrix has zeros on the diagonal; the others have the same bits.
TEST(Assembly, EnvironmentsMayBeLeftOut) {
  const std::vector<Index> env_blocks{0, 12, 13, 30, kBlocks};
  Random problem;
  // Stencils within environments.
  for (StencilSet* set : problem.sets) {
    std::vector<Index> block = read(set->view().block), offset = read(set->offsets());
    for (Index s = 0; s < set->size(); ++s) {
      const Index e = s % 4, blocks = env_blocks[e + 1] - env_blocks[e];
      for (Index i = offset[s]; i < offset[s + 1]; ++i)
        if (block[i] >= 0) block[i] = env_blocks[e] + block[i] % blocks;
    }
    write(set->view().block, block);
    set->pattern_changed();
  }
  std::vector<Index> row(kBlocks, -1), env_rows{0};
  Index rows = 0;
  for (Index e = 0; e < 4; ++e) {
    for (Index b = env_blocks[e]; b < env_blocks[e + 1]; ++b)
      if (b % 5 != 0) row[b] = rows++;
    env_rows.push_back(rows);
  }
  Assembler all, some;
  std::vector<std::uint8_t> whose;
  some.set_environments(env_blocks, whose);
  for (Assembler* a : {&all, &some}) a->set_rows(Buffer<Index>(row), rows, env_rows);
  BlockMatrix A, S;
  Buffer<Vec3> g, of_some;
  all.gradient(problem.sets, kBlocks, g);
  all.matrix(problem.sets, A);
  const std::vector<Vec3> want = g.download();
  const Dense whole = dense(A);
  for (unsigned marks : {15u, 5u, 8u, 0u, 7u}) {
    whose.clear();
    for (int e = 0; e < 4 && marks != 15; ++e) whose.push_back(marks >> e & 1);
    of_some.upload(std::vector<Vec3>(kBlocks, Vec3(1, 2, 3)));
    some.gradient(problem.sets, kBlocks, of_some);
    some.matrix(problem.sets, S);
    const std::vector<Vec3> found = of_some.download();
    const Dense matrix = dense(S);
    for (Index e = 0; e < 4; ++e) {
      const bool in = marks >> e & 1;
      for (Index b = env_blocks[e]; b < env_blocks[e + 1]; ++b) EXPECT_EQ(found[b], in ? want[b] : Vec3(1, 2, 3)) << marks << " " << b;
      const Index first = 3 * env_rows[e], n = 3 * (env_rows[e + 1] - env_rows[e]);
      EXPECT_EQ(matrix.block(first, first, n, n), in ? Dense(whole.block(first, first, n, n)) : Dense(Dense::Zero(n, n))) << marks << " " << e;
    }
    if (marks == 8) {
      EXPECT_LT(S.upper_blocks(), A.upper_blocks() / 2);
    }
  }
}

TEST(Assembly, RepeatedBlockInAStencilGivesBothHalves) {
  StencilSet set;
  set.resize_uniform(1, 2);
  set.need_hessian();
  write(set.view().block, {0, 0});
  write(set.view().grad, {Vec3(1, 2, 3), Vec3(10, 20, 30)});
  Mat3 h;
  h << 1, 2, 3, 4, 5, 6, 7, 8, 9;
  write(set.view().hess, {Mat3(Mat3::Identity()), h, Mat3(2 * Mat3::Identity())});
  set.pattern_changed();
  StencilSet* sets[] = {&set};
  Assembler assembler;
  assembler.set_rows(all_rows(1), 1);
  BlockMatrix A;
  Buffer<Vec3> g;
  assembler.matrix(sets, A);
  assembler.gradient(sets, 1, g);
  EXPECT_EQ(A.value.download()[0], Mat3(h + h.transpose() + 3 * Mat3::Identity()));
  EXPECT_EQ(g.download()[0], Vec3(11, 22, 33));
}

TEST(Assembly, FollowsAChangedContactSet) {
  Random problem;
  auto [rows, row, assembler, A] = OnRowsBackwards();
  for (Index n : {60, 7, 0, 90}) {
    problem.new_contact(n);
    expect_dense_sum(assembler, problem, row, rows, A);
  }
}

// How many blocks a contact set has the host hears with the structure of the matrix, in one copy, also where there are many more than last time.
TEST(Assembly, WaitsOnceForAChangedContactSet) {
  Random problem;
  auto [rows, row, assembler, A] = OnRowsBackwards();
  expect_dense_sum(assembler, problem, row, rows, A);
  problem.new_contact(62);
  const long long before = device::transfers().to_host;
  assembler.matrix(problem.sets, A);
  EXPECT_EQ(device::transfers().to_host - before, 1);
  for (Index n : {4, 3000, 5}) {
    problem.new_contact(n);
    expect_dense_sum(assembler, problem, row, rows, A);
  }
}

// The structure may be asked for with other things before: then matrix() does not wait, unless there are more blocks than there was room for: of few
// pieces a larger share is distinct.
TEST(Assembly, TheStructureMayBeAskedForBefore) {
  Random problem;
  auto [rows, row, assembler, A] = OnRowsBackwards();
  expect_dense_sum(assembler, problem, row, rows, A);
  const auto ask = [&assembler = assembler, &problem] {
    device::Fetch fetch;
    assembler.begin_matrix(problem.sets, fetch);
    fetch.now();
  };
  for (Index n : {62, 3000, 60}) {
    problem.new_contact(n);
    ask();
    const long long before = device::transfers().to_host;
    assembler.matrix(problem.sets, A);
    EXPECT_EQ(device::transfers().to_host - before > 0, n == 60) << n;
    expect_dense_sum(assembler, problem, row, rows, A);
  }
  // Of what nobody wanted in the end, and of sets that have changed since, nothing is used that is not so any more.
  for (Index n : {5, 4000, 6}) {
    problem.new_contact(n);
    ask();
    if (n == 6) ask();
    problem.new_contact(n + 1);
    expect_dense_sum(assembler, problem, row, rows, A);
  }
}

TEST(Assembly, FollowsChangedRows) {
  Random problem;
  Index rows;
  const std::vector<Index> row = rows_backwards(rows);
  std::vector<Index> half(kBlocks, -1);
  for (Index b = 0; b < kBlocks / 2; ++b) half[b] = b;
  Assembler assembler;
  BlockMatrix A;
  assembler.set_rows(Buffer<Index>(row), rows);
  expect_dense_sum(assembler, problem, row, rows, A);
  assembler.set_rows(Buffer<Index>(half), kBlocks / 2);
  expect_dense_sum(assembler, problem, half, kBlocks / 2, A);
}

TEST(Assembly, PatternStandsWhileTheStructureDoes) {
  Random problem;
  auto [rows, row, assembler, A] = OnRowsBackwards();
  assembler.matrix(problem.sets, A);
  const std::uint64_t first = A.pattern;
  problem.contact.pattern_changed();  // sorted again, but the same blocks
  expect_dense_sum(assembler, problem, row, rows, A);
  EXPECT_EQ(A.pattern, first);
  problem.new_contact();
  expect_dense_sum(assembler, problem, row, rows, A);
  EXPECT_NE(A.pattern, first);
}

TEST(Assembly, UnchangedSetsAreNotSortedAgain) {
  Random problem;
  auto [rows, row, assembler, A] = OnRowsBackwards();
  const auto launches = [](const std::string& name) {
    for (const auto& l : device::launch_counts())
      if (l.name == name) return l.launches;
    return 0LL;
  };
  assembler.matrix(problem.sets, A);
  const auto keys = launches("assembly.hess_keys"), merges = launches("assembly.merge");
  assembler.matrix(problem.sets, A);
  EXPECT_EQ(launches("assembly.hess_keys"), keys);
  EXPECT_EQ(launches("assembly.merge"), merges);
  problem.new_contact();
  assembler.matrix(problem.sets, A);
  EXPECT_EQ(launches("assembly.hess_keys"), keys + 1) << "only the contact set is sorted";
  EXPECT_GT(launches("assembly.merge"), merges);
}

TEST(Assembly, BitsDoNotDependOnThreadsNorOnSortingHistory) {
  std::vector<Mat3> first;
  std::vector<Vec3> first_g;
  for (int threads : {1, 2, 3}) {
    device::set_threads(threads);
    Random problem;
    problem.new_contact(3000, 5);  // groups of many chunks
    auto [rows, row, assembler, A] = OnRowsBackwards();
    Buffer<Vec3> g;
    if (threads == 3) {  // another contact set first
      Random other;
      other.new_contact(11);
      assembler.matrix(other.sets, A);
    }
    assembler.matrix(problem.sets, A);
    assembler.gradient(problem.sets, kBlocks, g);
    if (threads == 1) first = A.value.download(), first_g = g.download();
    EXPECT_EQ(A.value.download(), first);
    EXPECT_EQ(g.download(), first_g);
  }
  device::set_threads(0);
}

TEST(Assembly, AllBlocksEliminated) {
  Random problem;
  Assembler assembler;
  assembler.set_rows(Buffer<Index>(std::vector<Index>(kBlocks, -1)), 0);
  BlockMatrix A;
  expect_dense_sum(assembler, problem, std::vector<Index>(kBlocks, -1), 0, A);
  EXPECT_EQ(A.upper_blocks(), 0);
}
