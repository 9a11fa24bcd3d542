#include "model/ties.h"

#include <gtest/gtest.h>

#include <random>

#include "effects/list.h"
#include "scene_builder.h"

using namespace mortise;
using namespace mortise::testing;
using model::Follow;
using model::Model;
using model::Tie;

namespace {

// `n` balls in a row, a metre apart, and a box beside the last.
model::ModelInput row_of_balls(int n, const Vec3& velocity = Vec3::Zero(), const Vec3& turning = Vec3::Zero()) {
  model::ModelInput in;
  in.scene = Params::make_table();
  const Params steel = material("linear", 1e9, 0.3, 2000);
  for (int i = 0; i < n; ++i)
    in.bodies.push_back(stiff_body("ball" + std::to_string(i), geometry::sphere(0.5, 0.5), steel, {1.0 * i, 0, 0}, body_params(velocity, turning)));
  in.bodies.push_back(
      soft_body("pad", geometry::box({1, 1, 1}, 0.5), material("linear", 1e5, 0.3, 1000), {1.0 * n, 0, 0}, body_params(velocity, turning)));
  return in;
}

// The centre of a ball follows the place between it and the one before it, or the world: a chain of spherical joints.
std::vector<Tie> chain(const Model& m, int n) {
  std::vector<Tie> out;
  for (int i = 0; i < n; ++i) {
    Tie t;
    t.effect = "test", t.name = "j" + std::to_string(i), t.body = i, t.to = i - 1;
    const Vec3 place(i - 0.5 + 0.01 * i, 0.1 + 0.02 * i * i, 0.2 - 0.03 * i);
    Follow f{m.bodies[i].block_begin, {}};
    const auto add = [&](Index body, double sign) {
      const Vec3 X = place - m.bodies[body].centre;
      const Index b = m.bodies[body].block_begin;
      if (sign > 0) f.terms.push_back({b, 1});
      for (int k = 0; k < 3; ++k) f.terms.push_back({b + 1 + k, sign * X[k]});
    };
    if (i == 0)
      f.fixed = place;
    else
      add(i - 1, 1);
    add(i, -1);
    t.follows.push_back(f);
    out.push_back(t);
  }
  return out;
}

Tie bond(const Model& m, Index soft, Index stiff, std::vector<Index> nodes) {
  Tie t;
  t.effect = "test", t.name = "bond", t.body = soft, t.to = stiff;
  const std::vector<Vec3> rest = m.rest_points.download();
  for (Index n : nodes) {
    const Vec3 X = rest[m.bodies[soft].point_begin + n] - m.bodies[stiff].centre;
    const Index b = m.bodies[stiff].block_begin;
    t.follows.push_back({m.bodies[soft].block_begin + n, {{b, 1}, {b + 1, X[0]}, {b + 2, X[1]}, {b + 3, X[2]}}});
  }
  return t;
}

std::vector<Vec3> random(Index n, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Vec3> v(n);
  for (Vec3& x : v) x = Vec3(u(rng), u(rng), u(rng));
  return v;
}

template <class F>
std::string message(F f) {
  try {
    f();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::scene);
    return e.what();
  }
  return "";
}

}  // namespace

TEST(Ties, ComposeAlongAChain) {
  constexpr int n = 5;
  Model m(row_of_balls(n));
  std::vector<Tie> ties = chain(m, n);
  std::reverse(ties.begin(), ties.end());  // in whatever order they come
  ties.push_back(bond(m, n, n - 1, {0, 3, 7}));
  m.ties.add(m, ties);
  EXPECT_EQ(m.ties.order().size(), n + 3u);
  // The last centre hangs on the axes of all balls, a bonded node of the pad on no block besides; for places all of which differ.
  EXPECT_EQ(m.ties.terms(m.bodies[n - 1].block_begin).size(), 3u * n);
  EXPECT_EQ(m.ties.terms(m.bodies[n].block_begin + 7).size(), 3u * n);

  device::Buffer<Vec3> q(random(m.blocks, 1));
  m.ties.place(q.view());
  const std::vector<Vec3> x = q.download();
  for (const Tie& t : m.ties.list())
    for (const Follow& f : t.follows) {
      Vec3 sum = f.fixed;
      for (const model::TieTerm& term : f.terms) sum += term.weight * x[term.block];
      EXPECT_LT((x[f.block] - sum).norm(), 1e-14) << t.name;
    }
  EXPECT_TRUE(m.ties.pass(0, 1));
  EXPECT_TRUE(m.ties.pass(n, n - 1));
  EXPECT_FALSE(m.ties.pass(0, 2));
}

// T^T is the transpose of T: g . T z = T^T g . z, and nothing is left on tied blocks.
TEST(Ties, FoldIsTheTransposeOfCarry) {
  Model m(row_of_balls(4));
  std::vector<Tie> ties = chain(m, 4);
  ties.push_back(bond(m, 4, 3, {0, 1, 2, 3, 4, 5, 6, 7, 8}));
  m.ties.add(m, ties);
  const std::vector<Vec3> g = random(m.blocks, 2);
  device::Buffer<Vec3> way(random(m.blocks, 3)), force(g);
  m.ties.carry(way.view());
  m.ties.fold(force.view());
  const std::vector<Vec3> d = way.download(), folded = force.download();
  double whole = 0, free = 0, size = 0;
  for (Index b = 0; b < m.blocks; ++b) {
    whole += g[b].dot(d[b]), free += folded[b].dot(d[b]), size += g[b].norm() * d[b].norm();
    if (m.ties.tied(b)) {
      EXPECT_TRUE(folded[b].isZero(0));
      EXPECT_EQ(m.held[b], Model::kTied);
    }
  }
  EXPECT_NEAR(whole, free, 1e-14 * size);
  EXPECT_GT(std::abs(whole), 1e-3 * size);
}

TEST(Ties, RefuseWhatCannotBe) {
  const auto add = [](auto change) {
    return message([&] {
      Model m(row_of_balls(2));
      std::vector<Tie> ties = chain(m, 2);
      change(m, ties);
      m.ties.add(m, ties);
    });
  };
  EXPECT_EQ(add([](Model&, auto&) {}), "");
  EXPECT_NE(add([](Model& m, auto&) { m.held[m.bodies[1].block_begin] = 2; }).find("'ball1' that a pin holds"), std::string::npos);
  EXPECT_NE(add([](Model&, auto& t) { t[1].name = "j0"; }).find("two ties are called 'j0'"), std::string::npos);
  EXPECT_NE(add([](Model& m, auto& t) {
              t.push_back(bond(m, 2, 0, {1})), t.push_back(bond(m, 2, 1, {1})), t.back().name = "again";
            }).find("already: parts of 'pad'"),
            std::string::npos);
  EXPECT_NE(add([](Model& m, auto& t) {
              t[0].follows[0].terms.push_back({m.bodies[1].block_begin, 0.5});
            }).find("closes a circle"),
            std::string::npos);
}

TEST(Ties, TakeOverVelocities) {
  const auto start = [](const Vec3& velocity, const Vec3& turning, std::vector<Index> nodes, std::vector<Vec3>* v) {
    return message([&] {
      Model m(row_of_balls(1, velocity, turning));
      std::vector<Tie> ties = chain(m, 1);
      if (!nodes.empty()) ties.push_back(bond(m, 1, 0, nodes));
      m.ties.add(m, ties);
      *v = m.initial_velocity.download();
    });
  };
  std::vector<Vec3> v;
  EXPECT_EQ(start({0, 0, 0}, {0, 0, 2}, {}, &v), "");
  EXPECT_LT((v[0] - Vec3(0, 0, 2).cross(Vec3(0.5, -0.1, -0.2))).norm(), 1e-15);  // about the joint
  EXPECT_NE(start({1, 0, 0}, {0, 0, 2}, {}, &v).find("starts with the velocity"), std::string::npos);
  EXPECT_NE(start({0, 0, 0}, {0, 0, 2}, {0}, &v).find("'pad' starts with the velocity"), std::string::npos);
}

TEST(Ties, WhatHangsOnPrescribedBodiesIsPrescribed) {
  Model m(row_of_balls(2));
  for (Index b = 0; b < 4; ++b) m.held[b] = 2;
  m.bodies[0].carriage = 7;
  Tie fixed;
  fixed.effect = fixed.name = "fixed", fixed.body = 1, fixed.to = 0;
  for (Index k = 0; k < 4; ++k) fixed.follows.push_back({4 + k, {{k, 1}}});
  fixed.follows[0].terms.push_back({1, 1});
  m.ties.add(m, {fixed});
  EXPECT_EQ(m.bodies[1].carriage, 7);
  EXPECT_EQ(m.bodies[2].carriage, model::Body::kFree);
  EXPECT_TRUE(m.ties.held(4, m.held));
  m.held[1] = 0;
  EXPECT_FALSE(m.ties.held(4, m.held));
}
