#include "linalg/schwarz.h"

#include <gtest/gtest.h>

#include <cmath>

#include "linalg/cg.h"
#include "linalg/jacobi.h"
#include "problems.h"

using namespace mortise;
using namespace mortise::linalg;
using namespace mortise::linalg::test;

namespace {

// Environments of one elastic cube each, held at the bottom (which has no rows), pressed by stiff springs against a stiff body:
// an affine body of four rows above the cube.
struct Scene {
  std::vector<std::unique_ptr<Cube>> cubes;
  std::vector<std::unique_ptr<StencilSet>> sets;
  std::vector<Index> env_rows{0};
  RowPlaces rows;
  std::vector<Vec3> position;
  BlockMatrix A;

  // far: springs between rows far from each other.
  explicit Scene(const std::vector<Index>& cells, double contact = 1e6, Index far = 0) {
    std::vector<StencilSet*> all;
    std::vector<Index> row_of_block;
    for (std::size_t e = 0; e < cells.size(); ++e) add(cells[e], static_cast<Index>(2 * e), contact, row_of_block);
    if (far > 0) tie(far, row_of_block);
    for (auto& c : cubes) all.push_back(&c->elastic);
    for (auto& s : sets) all.push_back(s.get());
    Assembler assembler;
    assembler.set_rows(Buffer<Index>(row_of_block), env_rows.back());
    assembler.matrix(all, A);
  }

  void add_row(const Vec3& place, const Vec3& q, Index body, double moves) {
    rows.place.push_back(place), rows.body.push_back(body), rows.moves.push_back(moves);
    position.push_back(q);
  }

  void add(Index cells, Index body, double contact, std::vector<Index>& row_of_block) {
    const Index first = static_cast<Index>(row_of_block.size()), side = cells + 1, layer = side * side;
    cubes.push_back(std::make_unique<Cube>(cells, 0.0, first));
    for (Index n = 0; n < cubes.back()->nodes; ++n) {
      row_of_block.push_back(n < layer ? -1 : static_cast<Index>(rows.place.size()));
      const Vec3 x = Vec3(n % side, n / side % side, n / layer) / cells;
      if (n >= layer) add_row(x, x, body, 1);
    }
    const Index affine = static_cast<Index>(row_of_block.size());
    const Vec3 centre(0.5, 0.5, 1.2);
    for (int k = 0; k < 4; ++k) {
      row_of_block.push_back(static_cast<Index>(rows.place.size()));
      add_row(centre, k == 0 ? centre : Vec3(Vec3::Unit(k - 1)), body + 1, k == 0 ? 1 : 0);
    }
    env_rows.push_back(static_cast<Index>(rows.place.size()));

    // Inertia of the affine body (it holds its free motions), its orthogonality, and the springs y = p + sum X_k a_k against the top nodes.
    auto own = std::make_unique<StencilSet>(), springs = std::make_unique<StencilSet>();
    own->resize_uniform(4, 1);
    own->need_hessian();
    std::vector<Mat3> H{Mat3(10 * Mat3::Identity())};
    for (int k = 0; k < 3; ++k) {
      Mat3 h = Mat3::Identity();
      h(k, k) = 1e8;
      H.push_back(h);
    }
    write(own->view().block, {affine, affine + 1, affine + 2, affine + 3});
    write(own->view().hess, H);
    own->pattern_changed();
    springs->resize_uniform(layer, 5);
    springs->need_hessian();
    std::vector<Index> block;
    std::vector<Mat3> hess;
    for (Index n = 0; n < layer; ++n) {
      const Vec3 x = Vec3(n % side, n / side, cells) / cells - centre;
      const double w[5] = {1, -1, -x[0], -x[1], -x[2]};
      block.insert(block.end(), {first + cells * layer + n, affine, affine + 1, affine + 2, affine + 3});
      Mat3 nn = 0.01 * Mat3::Identity();
      nn(2, 2) = 1;
      for (int a = 0; a < 5; ++a)
        for (int b = a; b < 5; ++b) hess.push_back(contact / layer * w[a] * w[b] * nn);
    }
    write(springs->view().block, block), write(springs->view().hess, hess);
    springs->pattern_changed();
    sets.push_back(std::move(own)), sets.push_back(std::move(springs));
  }

  void tie(Index n, const std::vector<Index>& row_of_block) {
    std::vector<Index> free, block;
    for (std::size_t b = 0; b < row_of_block.size(); ++b)
      if (row_of_block[b] >= 0) free.push_back(static_cast<Index>(b));
    const auto count = static_cast<Index>(free.size()) - 4;
    std::vector<Mat3> hess;
    for (Index i = 0; i < n; ++i) {
      block.insert(block.end(), {free[i % count], free[(7 * i + count / 2) % count]});
      hess.insert(hess.end(), {Mat3::Identity(), -Mat3::Identity(), Mat3::Identity()});
    }
    auto set = std::make_unique<StencilSet>();
    set->resize_uniform(n, 2);
    set->need_hessian();
    write(set->view().block, block), write(set->view().hess, hess);
    set->pattern_changed();
    sets.push_back(std::move(set));
  }

  static std::vector<Vec3> apply(Schwarz& M, const std::vector<Vec3>& r) {
    Buffer<Vec3> in(r), out(static_cast<Index>(r.size()));
    M.apply(in.view(), out.view());
    return out.download();
  }
  CgResult solve(Preconditioner& M, Buffer<Vec3>& x, const std::vector<Vec3>& b, double relative) {
    const Buffer<Vec3> q(position), rhs(b);
    M.build(A, q.view());
    x.resize(A.rows);
    x.zero();
    return ConjugateGradients(env_rows).solve(A, M, rhs.view(), x.view(), std::vector<double>(env_rows.size() - 1, relative));
  }
};

// Motion of row i as a function of the motion of coarse item p: 3 x 6.
Eigen::Matrix<double, 3, 6> motion(const Vec3& d, double w) {
  Eigen::Matrix<double, 3, 6> P;
  P << w * Mat3::Identity(), Mat3::Zero();
  for (int k = 0; k < 3; ++k) P.col(3 + k) = Vec3(Vec3::Unit(k)).cross(d);
  return P;
}

// The definition: sum over levels of P (sum over domains of the inverse of the domain's part of P^T A P) P^T. Rotations are taken about the
// origin here: the space they span with the translations is the same.
Dense reference(const Dense& A, const Scene& scene) {
  const Domains domains = make_domains(scene.rows, scene.env_rows);
  Dense M = Dense::Zero(A.rows(), A.cols());
  std::vector<Index> item(scene.position.size());
  for (std::size_t i = 0; i < item.size(); ++i) item[i] = static_cast<Index>(i);
  for (std::size_t l = 0; l < domains.levels.size(); ++l) {
    const DomainLevel& level = domains.levels[l];
    const Index width = l == 0 ? 3 : 6;
    Dense P = Dense::Zero(A.rows(), width * level.items());
    for (std::size_t i = 0; i < item.size(); ++i) {
      if (item[i] < 0) continue;
      if (l == 0)
        P.block<3, 3>(3 * i, 3 * item[i]).setIdentity();
      else
        P.block<3, 6>(3 * i, 6 * item[i]) = motion(scene.position[i], scene.rows.moves[i]);
    }
    const Dense coarse = P.transpose() * A * P;
    for (Index d = 0; d < static_cast<Index>(domains.blocks.size()); ++d) {
      std::vector<int> pick;
      for (Index i = 0; i < level.items(); ++i)
        if (level.slot[i] / kSlots == d)
          for (Index k = 0; k < width; ++k) pick.push_back(width * i + k);
      if (pick.empty()) continue;
      const Dense local = coarse(pick, pick), columns = P(Eigen::all, pick);
      M += columns * local.completeOrthogonalDecomposition().pseudoInverse() * columns.transpose();
    }
    for (Index& i : item) i = i < 0 ? -1 : level.parent[i];
  }
  return M;
}

}  // namespace

TEST(Schwarz, DomainsAreSmallAndKeepToTheirEnvironment) {
  const Scene scene({4, 1, 6});
  const Domains domains = make_domains(scene.rows, scene.env_rows);
  ASSERT_GE(domains.levels.size(), 3u);
  const DomainLevel& fine = domains.levels[0];
  std::vector<Index> used(domains.blocks.size(), 0), env(domains.blocks.size(), -1);
  for (std::size_t e = 0; e + 1 < scene.env_rows.size(); ++e)
    for (Index i = scene.env_rows[e]; i < scene.env_rows[e + 1]; ++i) {
      const Index d = fine.slot[i] / kSlots;
      ++used[d];
      EXPECT_TRUE(env[d] < 0 || env[d] == static_cast<Index>(e));
      env[d] = static_cast<Index>(e);
    }
  for (Index d = 0; d < domains.fine; ++d) EXPECT_EQ(used[d], domains.blocks[d]);
  for (Index blocks : domains.blocks) EXPECT_LE(blocks, kSlots);
  // A cube of one cell and its body have eight rows: one domain, no coarser level.
  for (Index i = scene.env_rows[1]; i < scene.env_rows[2]; ++i) EXPECT_EQ(fine.parent[i], -1);
}

TEST(Schwarz, ManyBodiesStillGetCoarser) {
  RowPlaces rows;
  for (Index b = 0; b < 999; ++b)
    for (int k = 0; k < 4; ++k) rows.place.push_back(Vec3(b % 10, b / 10 % 10, b / 100)), rows.body.push_back(b), rows.moves.push_back(k == 0);
  const Domains domains = make_domains(rows, {0, 3996});
  for (Index i = 0; i < 3996; ++i) EXPECT_EQ(domains.levels[0].slot[i] / kSlots, domains.levels[0].slot[i / 4 * 4] / kSlots) << "bodies stay whole";
  EXPECT_LE(domains.levels.size(), 6u);
  EXPECT_EQ(domains.levels.back().parent[0], -1);
}

TEST(Schwarz, IsTheInverseWhenThereIsOneDomain) {
  Scene scene({1});
  Schwarz M(scene.rows, scene.env_rows);
  EXPECT_EQ(M.levels(), 1);
  Buffer<Vec3> x;
  const auto b = random_vector(scene.A.rows, 3);
  EXPECT_LE(scene.solve(M, x, b, 1e-6).iterations(), 2);
  const DenseVector want = dense(scene.A).llt().solve(dense(b));
  EXPECT_LT((dense(scene.apply(M, b)) - want).norm(), 1e-4 * want.norm()) << "single precision of the root";
}

TEST(Schwarz, IsItsDefinition) {
  Scene scene({6, 2});
  Schwarz M(scene.rows, scene.env_rows);
  ASSERT_GE(M.levels(), 3);
  const Buffer<Vec3> q(scene.position);
  M.build(scene.A, q.view());
  const Dense want = reference(dense(scene.A), scene);
  for (unsigned seed : {1u, 2u, 3u}) {
    const auto r = random_vector(scene.A.rows, seed);
    const DenseVector z = want * dense(r);
    EXPECT_LT((dense(scene.apply(M, r)) - z).norm(), 1e-5 * z.norm());
  }
}

// Levels have room for as many blocks as there were and some more, of which the host hears once; where that was too little they are found anew.
TEST(Schwarz, FollowsAMatrixWithOtherBlocks) {
  const Scene few({9}, 1e6, 1), more({9}, 1e6, 5), many({9}, 1e6, 4000);
  const Buffer<Vec3> q(few.position);
  Schwarz M(few.rows, few.env_rows);
  ASSERT_GE(M.levels(), 3);
  const std::vector<Vec3> r = random_vector(few.A.rows, 5);
  const auto waits = [&](const Scene& s) {
    const long long before = device::transfers().to_host;
    M.build(s.A, q.view());
    const long long there = device::transfers().to_host - before;
    Schwarz fresh(s.rows, s.env_rows);
    fresh.build(s.A, q.view());
    EXPECT_EQ(Scene::apply(M, r), Scene::apply(fresh, r));
    return there;
  };
  const Index levels = M.levels() - 1;
  EXPECT_EQ(waits(few), levels);
  EXPECT_EQ(waits(more), 1);
  EXPECT_EQ(waits(many), 1 + levels);
  EXPECT_EQ(waits(few), 1);
  EXPECT_EQ(waits(few), 0);
}

TEST(Schwarz, IsSymmetricAndPositive) {
  Scene scene({5, 3}, 1e9);
  Schwarz M(scene.rows, scene.env_rows);
  const Buffer<Vec3> q(scene.position);
  M.build(scene.A, q.view());
  for (unsigned seed : {1u, 2u, 3u}) {
    const auto x = random_vector(scene.A.rows, seed), y = random_vector(scene.A.rows, seed + 10);
    const DenseVector Mx = dense(scene.apply(M, x)), My = dense(scene.apply(M, y));
    EXPECT_NEAR(dense(y).dot(Mx), dense(x).dot(My), 1e-12 * Mx.norm() * dense(y).norm());
    EXPECT_GT(dense(x).dot(Mx), 0);
  }
}

TEST(Schwarz, NeedsFarFewerIterationsThanJacobi) {
  for (double contact : {1e4, 1e7}) {
    Scene scene({12}, contact);
    Schwarz M(scene.rows, scene.env_rows);
    BlockJacobi jacobi(scene.env_rows);
    Buffer<Vec3> x, y;
    const auto b = random_vector(scene.A.rows, 1);
    const CgResult with = scene.solve(M, x, b, 1e-8), without = scene.solve(jacobi, y, b, 1e-8);
    ASSERT_TRUE(with.converged() && without.converged());
    EXPECT_LT(3 * with.iterations(), without.iterations());
    const DenseVector want = dense(y.download());
    EXPECT_LT((dense(x.download()) - want).norm(), 1e-5 * want.norm());
  }
}

TEST(Schwarz, IterationsGrowSlowly) {
  Index small = 0, large = 0;
  for (Index cells : {6, 14}) {
    Scene scene({cells});
    Schwarz M(scene.rows, scene.env_rows);
    Buffer<Vec3> x;
    (cells == 6 ? small : large) = scene.solve(M, x, random_vector(scene.A.rows, 1), 1e-8).iterations();
  }
  EXPECT_LT(large, 1.8 * small) << "block Jacobi: in proportion to the cells, 2.3 times as many";
}

TEST(Schwarz, EnvironmentsDoNotFeelTheirNeighbours) {
  const std::vector<Index> cells{5, 2, 4};
  Scene both(cells);
  Schwarz M(both.rows, both.env_rows);
  std::vector<Vec3> b;
  for (Index c : cells)
    for (const Vec3& v : random_vector(Scene({c}).A.rows, c)) b.push_back(v);
  Buffer<Vec3> x;
  const CgResult r = both.solve(M, x, b, 1e-8);
  const auto all = x.download();
  for (std::size_t e = 0; e < cells.size(); ++e) {
    Scene one({cells[e]});
    Schwarz own(one.rows, one.env_rows);
    Buffer<Vec3> alone;
    const CgResult s = one.solve(own, alone, random_vector(one.A.rows, cells[e]), 1e-8);
    EXPECT_EQ(s.env[0].iterations, r.env[e].iterations);
    EXPECT_EQ(alone.download(), std::vector<Vec3>(all.begin() + both.env_rows[e], all.begin() + both.env_rows[e + 1]));
  }
}

TEST(Schwarz, BitsDoNotDependOnThreads) {
  std::vector<Vec3> first;
  for (int threads : {1, 2}) {
    device::set_threads(threads);
    Scene scene({6, 3});
    Schwarz M(scene.rows, scene.env_rows);
    Buffer<Vec3> x;
    EXPECT_TRUE(scene.solve(M, x, random_vector(scene.A.rows, 1), 1e-8).converged());
    if (threads == 1) first = x.download();
    EXPECT_EQ(x.download(), first);
  }
  device::set_threads(0);
}

// Turned and moved as a whole, the hierarchy follows the current positions.
TEST(Schwarz, FollowsLargeMotions) {
  Scene scene({8});
  const Mat3 R = Eigen::AngleAxisd(1.2, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  Schwarz M(scene.rows, scene.env_rows);
  Buffer<Vec3> x;
  const auto b = random_vector(scene.A.rows, 1);
  const Index before = scene.solve(M, x, b, 1e-8).iterations();
  auto value = scene.A.value.download();
  for (Mat3& v : value) v = (R * v * R.transpose()).eval();
  scene.A.value.upload(value);
  for (std::size_t i = 0; i < scene.position.size(); ++i) scene.position[i] = R * scene.position[i] + scene.rows.moves[i] * Vec3(100, -50, 20);
  auto turned = b;
  for (Vec3& v : turned) v = (R * v).eval();
  EXPECT_NEAR(scene.solve(M, x, turned, 1e-8).iterations(), before, 0.1 * before + 2);
}

TEST(Schwarz, FloatingBodiesAreNoObstacle) {
  Cube cube(6, 1e-6);  // all but free: the coarsest pivots are rounding
  BlockMatrix A;
  cube_matrix(cube, A);
  RowPlaces rows;
  for (Index n = 0; n < cube.nodes; ++n) rows.place.push_back(Vec3(n % 7, n / 7 % 7, n / 49) / 6), rows.body.push_back(0), rows.moves.push_back(1);
  const std::vector<Index> env_rows{0, cube.nodes};
  Schwarz M(rows, env_rows);
  const Buffer<Vec3> q(rows.place);
  M.build(A, q.view());
  const Buffer<Vec3> y(random_vector(cube.nodes, 1));
  Buffer<Vec3> rhs(cube.nodes);
  multiply(A, y.view(), rhs.view());
  Buffer<Vec3> x(cube.nodes);
  x.zero();
  const CgResult r = ConjugateGradients(env_rows).solve(A, M, std::as_const(rhs).view(), x.view(), {1e-6});
  EXPECT_TRUE(r.converged());
  EXPECT_LT(r.iterations(), 200);
}

// Bodies whose position is held have rows for their axes only, which no translation moves: half the coarse unknowns do nothing.
TEST(Schwarz, CoarseUnknownsThatDoNothingAreLeftOut) {
  constexpr Index kBodies = 40, kRows = 3 * kBodies;
  RowPlaces rows;
  std::vector<Vec3> position;
  for (Index i = 0; i < kRows; ++i) {
    rows.place.push_back(Vec3(i / 3, 0, 0)), rows.body.push_back(i / 3), rows.moves.push_back(0);
    position.push_back(Vec3::Unit(i % 3));
  }
  StencilSet own;
  own.resize_uniform(kRows, 1);
  own.need_hessian();
  std::vector<Index> each(kRows);
  for (Index i = 0; i < kRows; ++i) each[i] = i;
  write(own.view().block, each);
  write(own.view().hess, std::vector<Mat3>(kRows, 5 * Mat3::Identity()));
  own.pattern_changed();
  Assembler assembler;
  assembler.set_rows(all_rows(kRows), kRows);
  StencilSet* sets[] = {&own};
  BlockMatrix A;
  assembler.matrix(sets, A);
  const std::vector<Index> env_rows{0, kRows};
  Schwarz M(rows, env_rows);
  ASSERT_GT(M.levels(), 1);
  const Buffer<Vec3> q(position), b(random_vector(kRows, 1));
  M.build(A, q.view());
  Buffer<Vec3> x(kRows);
  x.zero();
  EXPECT_TRUE(ConjugateGradients(env_rows).solve(A, M, b.view(), x.view(), {1e-8}).converged());
  const DenseVector wrong = 5 * dense(x.download()) - dense(b.download());
  EXPECT_LT(wrong.norm(), 1e-6);
}

TEST(Schwarz, ReportsAMatrixThatIsNotPositiveDefinite) {
  Scene scene({5, 3});
  const auto good = scene.A.value.download();
  for (double bad : {-1e6, std::nan("")}) {
    auto value = good;
    value[scene.A.row_start.download()[scene.env_rows[1] + 3]](1, 1) = bad;
    scene.A.value.upload(value);
    Schwarz M(scene.rows, scene.env_rows);
    Buffer<Vec3> x;
    const CgResult r = scene.solve(M, x, random_vector(scene.A.rows, 1), 1e-8);
    EXPECT_EQ(r.env[0].end, CgEnd::converged);
    EXPECT_EQ(r.env[1].end, CgEnd::not_positive_definite);
    EXPECT_EQ(r.env[1].iterations, 0);
    for (const Vec3& v : x.download()) EXPECT_TRUE(v.allFinite());
  }
}
