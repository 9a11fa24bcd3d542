// The factor by itself: structures that have little in common, both precisions, any number of threads.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

#include "linalg/cholesky/factor.h"
#include "linalg/cholesky/order.h"
#include "linalg/cholesky/tuning.h"
#include "problems.h"

using namespace mortise;
using namespace mortise::linalg;
using namespace mortise::linalg::test;
using cholesky::Factor;
using cholesky::Supernodes;

namespace {

// Upper blocks of a symmetric matrix, by rows.
struct Blocks {
  std::vector<Index> row_start{0}, col;
  std::vector<Mat3> value;

  Dense dense() const {
    const Index rows = static_cast<Index>(row_start.size()) - 1;
    Dense out = Dense::Zero(3 * rows, 3 * rows);
    for (Index r = 0; r < rows; ++r)
      for (Index k = row_start[r]; k < row_start[r + 1]; ++k) {
        out.block<3, 3>(3 * r, 3 * col[k]) = value[k];
        out.block<3, 3>(3 * col[k], 3 * r) = value[k].transpose();
      }
    return out;
  }
};

// Positive definite, with these couplings (row < column).
Blocks random_matrix(Index rows, const std::vector<std::pair<Index, Index>>& couplings, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<std::vector<Index>> of_row(rows);
  for (const auto& [r, c] : couplings) of_row[r].push_back(c);
  std::vector<double> sum(rows, 0.5);
  Blocks out;
  for (Index r = 0; r < rows; ++r) {
    std::sort(of_row[r].begin(), of_row[r].end());
    of_row[r].erase(std::unique(of_row[r].begin(), of_row[r].end()), of_row[r].end());
    out.col.push_back(r);
    out.value.push_back(Mat3::Zero());
    for (Index c : of_row[r]) {
      out.col.push_back(c);
      Mat3 m;
      for (int i = 0; i < 9; ++i) m.data()[i] = u(rng);
      out.value.push_back(m);
      sum[r] += m.cwiseAbs().rowwise().sum().maxCoeff(), sum[c] += m.cwiseAbs().colwise().sum().maxCoeff();
    }
    out.row_start.push_back(static_cast<Index>(out.col.size()));
  }
  for (Index r = 0; r < rows; ++r) out.value[out.row_start[r]] = sum[r] * Mat3::Identity();
  return out;
}

Supernodes supernodes_of(const Blocks& A) { return cholesky::find_supernodes(A.row_start, A.col, cholesky::find_order(A.row_start, A.col)); }

using Couplings = std::vector<std::pair<Index, Index>>;
Couplings chain(Index n) {
  Couplings out;
  for (Index i = 0; i + 1 < n; ++i) out.push_back({i, i + 1});
  return out;
}
Couplings arrow(Index n) {
  Couplings out;
  for (Index i = 0; i + 1 < n; ++i) out.push_back({i, n - 1});
  return out;
}
Couplings grid(Index side) {
  Couplings out;
  const auto id = [side](Index x, Index y, Index z) { return (z * side + y) * side + x; };
  for (Index z = 0; z < side; ++z)
    for (Index y = 0; y < side; ++y)
      for (Index x = 0; x < side; ++x)
        for (Index dz = 0; dz < 2; ++dz)
          for (Index dy = 0; dy < 2; ++dy)
            for (Index dx = 0; dx < 2; ++dx)
              if (dx + dy + dz > 0 && x + dx < side && y + dy < side && z + dz < side) out.push_back({id(x, y, z), id(x + dx, y + dy, z + dz)});
  return out;
}
Couplings full(Index n) {
  Couplings out;
  for (Index i = 0; i < n; ++i)
    for (Index j = i + 1; j < n; ++j) out.push_back({i, j});
  return out;
}
// Two of them that know nothing of each other, and a row that knows nobody.
Couplings apart(Index side) {
  Couplings out = grid(side);
  const Index n = side * side * side;
  for (const auto& [r, c] : grid(side)) out.push_back({r + n, c + n});
  return out;
}

struct Case {
  const char* name;
  Index rows;
  Couplings couplings;
};
std::vector<Case> cases() {
  return {{"one row", 1, {}},     {"no couplings", 40, {}},     {"chain", 300, chain(300)},      {"arrow", 200, arrow(200)},
          {"full", 60, full(60)}, {"grid", 8 * 8 * 8, grid(8)}, {"apart", 2 * 125 + 1, apart(5)}};
}

template <class Real>
double error_of(const Blocks& A, std::vector<Vec3>* solution = nullptr) {
  const Supernodes t = supernodes_of(A);
  Factor<Real> factor;
  EXPECT_TRUE(factor.compute(t, A.value.data()));
  std::vector<Vec3> b = random_vector(static_cast<Index>(A.row_start.size()) - 1, 3), x(b.size());
  factor.solve(t, b.data(), x.data());
  if (solution) *solution = x;
  const DenseVector want = A.dense().llt().solve(dense(b));
  return (dense(x) - want).norm() / want.norm();
}

}  // namespace

TEST(Supernodes, HoldEveryRowOnceAndEveryBlockWhereItBelongs) {
  for (const Case& c : cases()) {
    const Blocks A = random_matrix(c.rows, c.couplings, 7);
    const Supernodes t = supernodes_of(A);
    std::vector<int> seen(c.rows, 0);
    for (Index r : t.order) ++seen[r];
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), c.rows) << c.name;
    // The entries put the matrix, in its new order, together again: lower triangle.
    Dense sum = Dense::Zero(3 * c.rows, 3 * c.rows);
    for (Index s = 0; s < t.count(); ++s)
      for (std::size_t k = t.entries[s]; k < t.entries[s + 1]; ++k) {
        const Supernodes::Entry& e = t.entry[k];
        const Index row = t.row[t.row_start[s] + e.row], column = t.first[s] + e.column;
        sum.block<3, 3>(3 * row, 3 * column) += e.transposed ? Mat3(A.value[e.value].transpose()) : A.value[e.value];
      }
    const Dense want = A.dense();
    for (Index i = 0; i < c.rows; ++i)
      for (Index j = 0; j <= i; ++j)
        EXPECT_EQ((sum.block<3, 3>(3 * i, 3 * j)), (want.block<3, 3>(3 * t.order[i], 3 * t.order[j]))) << c.name << ' ' << i << ' ' << j;
  }
}

TEST(Cholesky, SolvesInBothPrecisions) {
  for (const Case& c : cases()) {
    const Blocks A = random_matrix(c.rows, c.couplings, 11);
    EXPECT_LT(error_of<double>(A), 1e-13) << c.name;
    EXPECT_LT(error_of<float>(A), 1e-5) << c.name;
    EXPECT_GT(error_of<float>(A), c.rows == 1 ? 0 : 1e-9) << c.name << ": single precision is not that good";
  }
}

// Large enough for tiles, and for children whose rows are added up in parallel.
TEST(Cholesky, LargePanelsAreThoseOfSmallOnes) {
  for (const Couplings& couplings : {full(400), grid(17)}) {
    Index rows = 0;
    for (const auto& [r, c] : couplings) rows = std::max(rows, c + 1);
    const Blocks A = random_matrix(rows, couplings, 5);
    const Supernodes t = supernodes_of(A);
    EXPECT_GT(t.flops.back(), 10 * cholesky::tuning::kLargePanel);
    std::vector<Vec3> b = random_vector(rows, 3);
    Factor<double> factor;
    ASSERT_TRUE(factor.compute(t, A.value.data()));
    std::vector<Vec3> x(rows);
    factor.solve(t, b.data(), x.data());
    std::vector<Vec3> left = b;  // b - A x
    for (Index r = 0; r < rows; ++r)
      for (Index k = A.row_start[r]; k < A.row_start[r + 1]; ++k) {
        left[r] -= A.value[k] * x[A.col[k]];
        if (A.col[k] != r) left[A.col[k]] -= A.value[k].transpose() * x[r];
      }
    EXPECT_LT(dense(left).norm(), 1e-13 * dense(b).norm());
  }
}

TEST(Cholesky, BitsDoNotDependOnThreads) {
  const Blocks A = random_matrix(17 * 17 * 17, grid(17), 5);
  const Supernodes t = supernodes_of(A);
  const std::vector<Vec3> b = random_vector(17 * 17 * 17, 3);
  std::vector<Vec3> first, first_rough;
  for (int threads : {1, 2, 4}) {
    device::set_threads(threads);
    Factor<double> factor;
    Factor<float> rough;
    std::vector<Vec3> x(b.size()), y(b.size());
    ASSERT_TRUE(factor.compute(t, A.value.data()) && rough.compute(t, A.value.data()));
    factor.solve(t, b.data(), x.data());
    rough.solve(t, b.data(), y.data());
    if (threads == 1) first = x, first_rough = y;
    EXPECT_EQ(x, first) << threads;
    EXPECT_EQ(y, first_rough) << threads;
  }
  device::set_threads(0);
}

TEST(Cholesky, KnowsWhatItCannotFactor) {
  const Blocks good = random_matrix(512, grid(8), 5);
  const Supernodes t = supernodes_of(good);
  Factor<double> factor;
  EXPECT_TRUE(factor.compute(t, good.value.data()));
  EXPECT_GT(factor.reciprocal_condition(), 0);
  for (Index row : {0, 100, 511})
    for (double bad : {-1e3, 0.0, std::nan(""), static_cast<double>(INFINITY)}) {
      std::vector<Mat3> value = good.value;
      value[good.row_start[row]](2, 2) = bad;
      EXPECT_FALSE(factor.compute(t, value.data())) << row << ' ' << bad;
    }
  EXPECT_TRUE(factor.compute(t, good.value.data())) << "usable again afterwards";
}
