#include "linalg/gmres.h"

#include "problems.h"

using namespace mortise;
using namespace mortise::linalg;
using namespace mortise::linalg::test;

namespace {

// Two environments with unsymmetric dense matrices of different size; the second one's right-hand side can be zero.
struct Pair {
  std::vector<Index> rows{0, 20, 52};
  Dense A = Dense::Zero(156, 156);
  std::vector<Vec3> b = random_vector(52, 3);
  Buffer<Vec3> rhs, x{52};

  Pair() {
    std::srand(5);
    for (int e = 0; e < 2; ++e) {
      const Index first = 3 * rows[e], n = 3 * (rows[e + 1] - rows[e]);
      A.block(first, first, n, n) = Dense::Random(n, n) + 10 * (e + 1) * Dense::Identity(n, n);
    }
  }
  static Operator by(const Dense& M) {
    return [M](View<const Vec3> in, View<Vec3> out) {
      const DenseVector y = M * dense(read(in));
      std::vector<Vec3> to(out.n);
      for (Index i = 0; i < out.n; ++i) to[i] = y.segment<3>(3 * i);
      write(out, to);
    };
  }
  GmresResult solve(const Dense& preconditioner, double relative, Index most = 200) {
    rhs.upload(b);
    return gmres(by(A), awaited(by(preconditioner)), rhs.view(), x.view(), rows, std::vector<double>(rows.size() - 1, relative), most);
  }
};

}  // namespace

TEST(Gmres, SolvesUnsymmetricSystems) {
  Pair p;
  const GmresResult r = p.solve(Dense::Identity(156, 156), 1e-10);
  const DenseVector want = p.A.partialPivLu().solve(dense(p.b));
  EXPECT_LT((dense(p.x.download()) - want).norm(), 1e-8 * want.norm());
  // The stated residual is the true one.
  const DenseVector left = dense(p.b) - p.A * dense(p.x.download());
  for (int e = 0; e < 2; ++e) {
    const Index first = 3 * p.rows[e], n = 3 * (p.rows[e + 1] - p.rows[e]);
    EXPECT_NEAR(left.segment(first, n).norm() / dense(p.b).segment(first, n).norm(), r.relative[e], 1e-12);
    EXPECT_LE(r.relative[e], 1e-10);
  }
}

TEST(Gmres, AnExactPreconditionerTakesOneIteration) {
  Pair p;
  EXPECT_EQ(p.solve(p.A.inverse(), 1e-8).iterations, 1);
}

TEST(Gmres, EnvironmentsDoNotSeeEachOther) {
  Pair both, alone;
  for (Index i = 20; i < 52; ++i) alone.b[i] = Vec3::Zero();
  const GmresResult all = both.solve(Dense::Identity(156, 156), 0, 12), one = alone.solve(Dense::Identity(156, 156), 0, 12);
  EXPECT_EQ(all.relative[0], one.relative[0]);
  EXPECT_EQ(one.relative[1], 0);
  const std::vector<Vec3> a = both.x.download(), b = alone.x.download();
  for (Index i = 0; i < 20; ++i) EXPECT_EQ(a[i], b[i]);
  for (Index i = 20; i < 52; ++i) EXPECT_EQ(b[i], Vec3::Zero());
}

TEST(Gmres, StopsAtTheLimitWithTheBestSoFar) {
  Pair p;
  const GmresResult r = p.solve(Dense::Identity(156, 156), 1e-14, 5);
  EXPECT_EQ(r.iterations, 5);
  EXPECT_GT(r.relative[0], 1e-14);
  EXPECT_LT((dense(p.b) - p.A * dense(p.x.download())).norm(), dense(p.b).norm());
}

// Products are asked for those that have not ended.
TEST(Gmres, SaysWhoGoesOn) {
  Pair p;
  for (Index i = 0; i < 20; ++i) p.b[i] *= 1e-3;
  p.rhs.upload(p.b);
  std::vector<Index> told(2, 0);
  const GmresResult r = gmres(Pair::by(p.A), awaited(Pair::by(Dense::Identity(156, 156))), p.rhs.view(), p.x.view(), p.rows, {1e-6, 1e-6}, 200,
                              [&](const std::vector<std::uint8_t>& going) {
                                for (int e = 0; e < 2; ++e) told[e] += going[e];
                              });
  EXPECT_EQ(told, r.of_env);
}

// One that has converged stands still while the other goes on.
TEST(Gmres, EveryEnvironmentEndsByItself) {
  Pair both, alone;
  for (Index i = 0; i < 20; ++i) both.b[i] *= 1e-3;  // only relative residuals count
  for (Index i = 20; i < 52; ++i) alone.b[i] = Vec3::Zero();
  for (Index i = 0; i < 20; ++i) alone.b[i] = both.b[i];
  const GmresResult all = both.solve(Dense::Identity(156, 156), 1e-6), one = alone.solve(Dense::Identity(156, 156), 1e-6);
  ASSERT_NE(all.of_env[0], all.of_env[1]) << "or the test means nothing";
  EXPECT_EQ(all.iterations, std::max(all.of_env[0], all.of_env[1]));
  EXPECT_EQ(all.of_env[0], one.iterations);
  const std::vector<Vec3> a = both.x.download(), b = alone.x.download();
  for (Index i = 0; i < 20; ++i) EXPECT_EQ(a[i], b[i]);
}
