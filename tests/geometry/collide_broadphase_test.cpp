#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <numeric>

#include "collide_helpers.h"
#include "geometry/collide/broadphase.h"
#include "geometry/collide/distance.h"
#include "geometry/collide/tuning.h"

namespace mortise::geometry {
namespace {

using device::Buffer;
using device::View;

struct BruteForce {
  std::vector<std::array<Index, 2>> pt, ee;
};

struct Box {
  Vec3 lo, hi;
};
Box box(const Index* v, int n, const std::vector<Vec3>& y, const std::vector<Vec3>& dy, double radius) {
  Box b{y[v[0]], y[v[0]]};
  for (int i = 0; i < n; ++i) {
    b.lo = b.lo.cwiseMin(y[v[i]]), b.hi = b.hi.cwiseMax(y[v[i]]);
    if (dy.empty()) continue;
    const Vec3 end = y[v[i]] + dy[v[i]];
    b.lo = b.lo.cwiseMin(end), b.hi = b.hi.cwiseMax(end);
  }
  b.lo.array() -= radius / 2;
  b.hi.array() += radius / 2;
  return b;
}
bool overlap(const Box& a, const Box& b) { return (a.lo.array() <= b.hi.array()).all() && (b.lo.array() <= a.hi.array()).all(); }

// All pairs of environment after environment, in the order of ids.
BruteForce brute_force(const test::Soup& s, const std::vector<Vec3>& y, const std::vector<Vec3>& dy, double radius) {
  BruteForce out;
  const auto watched = [&](Index a, Index b) { return s.env[a] == s.env[b] && s.allowed[s.body[a] * s.bodies + s.body[b]]; };
  // Of one body: no nearer than the radius, whatever its corners do to each other.
  const auto far = [&](std::vector<Index> v, std::size_t first) {
    if (s.body[v[0]] != s.body[v[first]]) return false;
    Vec3 x[4];
    for (int k = 0; k < 4; ++k) x[k] = y[v[k]];
    double way = 0;
    for (std::size_t i = 0; i < first && !dy.empty(); ++i)
      for (std::size_t j = first; j < 4; ++j) way = std::max(way, (dy[v[i]] - dy[v[j]]).norm());
    return std::sqrt(first == 1 ? closest_point_triangle(x).squared : closest_edge_edge(x).squared) > radius + way;
  };
  const Index envs = s.env.empty() ? 0 : *std::max_element(s.env.begin(), s.env.end()) + 1;
  for (Index e = 0; e < envs; ++e) {
    for (Index p = 0; p < static_cast<Index>(s.points.size()); ++p)
      for (Index t = 0; s.env[p] == e && t < static_cast<Index>(s.triangles.size()); ++t) {
        const Index* v = s.triangles[t].v;
        if (!watched(p, v[0]) || v[0] == p || v[1] == p || v[2] == p) continue;
        if (overlap(box(&p, 1, y, dy, radius), box(v, 3, y, dy, radius)) && !far({p, v[0], v[1], v[2]}, 1)) out.pt.push_back({p, t});
      }
    for (Index a = 0; a < static_cast<Index>(s.edges.size()); ++a)
      for (Index b = a + 1; s.env[s.edges[a].v[0]] == e && b < static_cast<Index>(s.edges.size()); ++b) {
        const Index *v = s.edges[a].v, *w = s.edges[b].v;
        if (!watched(v[0], w[0]) || v[0] == w[0] || v[0] == w[1] || v[1] == w[0] || v[1] == w[1]) continue;
        if (overlap(box(v, 2, y, dy, radius), box(w, 2, y, dy, radius)) && !far({v[0], v[1], w[0], w[1]}, 2)) out.ee.push_back({a, b});
      }
  }
  return out;
}

void expect_exact(const test::Soup& s, const Broadphase& found, const BruteForce& truth) {
  const auto pt = test::download(found.point_triangles());
  const auto ee = test::download(found.edge_edges());
  ASSERT_EQ(pt.size(), truth.pt.size());
  ASSERT_EQ(ee.size(), truth.ee.size());
  for (std::size_t i = 0; i < pt.size(); ++i) {
    ASSERT_EQ(pt[i].point, truth.pt[i][0]);
    ASSERT_EQ(pt[i].triangle, truth.pt[i][1]);
    ASSERT_EQ(pt[i].v[0], pt[i].point);
    ASSERT_EQ(0, std::memcmp(pt[i].v + 1, s.triangles[pt[i].triangle].v, 3 * sizeof(Index)));
  }
  for (std::size_t i = 0; i < ee.size(); ++i) {
    ASSERT_EQ(ee[i].a, truth.ee[i][0]);
    ASSERT_EQ(ee[i].b, truth.ee[i][1]);
    ASSERT_EQ(0, std::memcmp(ee[i].v, s.edges[ee[i].a].v, 2 * sizeof(Index)));
    ASSERT_EQ(0, std::memcmp(ee[i].v + 2, s.edges[ee[i].b].v, 2 * sizeof(Index)));
  }
  for (std::size_t e = 0; e + 1 < found.pt_env_offset().size(); ++e) {
    for (Index i = found.pt_env_offset()[e]; i < found.pt_env_offset()[e + 1]; ++i) ASSERT_EQ(s.env[pt[i].point], static_cast<Index>(e));
    for (Index i = found.ee_env_offset()[e]; i < found.ee_env_offset()[e + 1]; ++i) ASSERT_EQ(s.env[ee[i].v[0]], static_cast<Index>(e));
  }
  ASSERT_EQ(found.pt_env_offset().back(), static_cast<Index>(pt.size()));
  ASSERT_EQ(found.ee_env_offset().back(), static_cast<Index>(ee.size()));
}

// Bodies of all environments fill the same space, environments are interleaved, and only some pairs are watched.
test::Soup many_bodies(int bodies, int envs, int squares, unsigned seed, bool self) {
  test::Random r(seed);
  test::Soup s;
  for (int b = 0; b < bodies; ++b) test::add_patch(s, r, squares, 1, test::random_vec(r, 0.6), b * 7 % envs);
  s.allowed.assign(bodies * bodies, 0);
  for (int a = 0; a < bodies; ++a)
    for (int b = 0; b < bodies; ++b) s.allowed[a * bodies + b] = a == b ? self : (a + b) % 5 != 0;
  return s;
}

struct Case {
  int bodies, envs, squares;
  bool self, moves;
  double radius;
};
class BroadphaseCases : public testing::TestWithParam<Case> {};

TEST_P(BroadphaseCases, FindsExactlyTheBruteForcePairs) {
  const Case c = GetParam();
  const test::Soup s = many_bodies(c.bodies, c.envs, c.squares, 11, c.self);
  const Surface surface = s.surface();
  Broadphase broadphase(surface);
  test::Random r(5);
  std::vector<Vec3> y = s.points, dy;
  for (int pass = 0; pass < 3; ++pass) {  // later passes reuse the order of the leaves
    if (c.moves) {
      dy.resize(y.size());
      for (Vec3& d : dy) d = test::random_vec(r, 0.1);
    }
    const Buffer<Vec3> yb(y), dyb(dy);
    broadphase.update(yb.view(), dyb.view(), c.radius);
    const BruteForce truth = brute_force(s, y, dy, c.radius);
    ASSERT_FALSE(truth.pt.empty());
    ASSERT_FALSE(truth.ee.empty());
    expect_exact(s, broadphase, truth);
    for (Vec3& p : y) p += test::random_vec(r, 0.3);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, BroadphaseCases,
                         testing::Values(Case{2, 1, 8, false, false, 0.05}, Case{2, 1, 8, true, true, 0.0}, Case{9, 3, 4, true, false, 0.1},
                                         Case{40, 17, 2, false, true, 0.02}, Case{5, 1, 3, true, false, 10.0}));

// Answers picked from an earlier search are those of a search.
TEST(Broadphase, PicksExactlyWhatItWouldFind) {
  for (bool self : {false, true}) {
    const test::Soup s = many_bodies(9, 3, 4, 17, self);
    const Surface surface = s.surface();
    Broadphase broadphase(surface);
    test::Random r(23);
    std::vector<Vec3> y = s.points, dy(y.size());
    double length = 1e-2;
    for (int pass = 0; pass < 60; ++pass) {
      const double radius = pass % 3 == 2 ? 0.02 : 0.01;
      for (std::size_t i = 0; i < dy.size(); ++i)  // at random, or bodies as a whole against each other
        dy[i] = pass < 40 ? test::random_vec(r, length) : length * Vec3(s.body[i] % 2 ? 1 : -1, 0, 0);
      const bool moves = pass % 4 != 3;
      const Buffer<Vec3> yb(y), dyb(dy);
      broadphase.update(yb.view(), moves ? dyb.view() : device::View<const Vec3>{}, radius);
      const BruteForce truth = brute_force(s, y, moves ? dy : std::vector<Vec3>{}, radius);
      ASSERT_FALSE(truth.ee.empty());
      expect_exact(s, broadphase, truth);
      for (std::size_t i = 0; i < y.size(); ++i) y[i] += dy[i];
      length = pass % 20 == 19 ? 1e-2 : 0.7 * length;
    }
    EXPECT_LT(broadphase.searches(), 3 * 30);  // in three environments most are picked,
    EXPECT_GT(broadphase.searches(), 3 * 2);   // but not all can be
  }
}

// What is kept may answer without waiting, on the guess that it serves, and says afterwards whether it did.
TEST(Broadphase, AGuessIsTheAnswerOrSaysThatItIsNone) {
  const test::Soup s = many_bodies(9, 3, 4, 17, true);
  const Surface surface = s.surface();
  Broadphase broadphase(surface);
  test::Random r(37);
  std::vector<Vec3> y = s.points, dy(y.size());
  for (Vec3& d : dy) d = test::random_vec(r, 1e-4);
  const Buffer<Vec3> dyb(dy);
  device::Fetch fetch;
  const auto guess = [&](const Buffer<Vec3>& at) { return broadphase.guess(at.view(), dyb.view(), 0.02, {}, fetch); };
  const Buffer<Vec3> first(y);
  const auto none = guess(first);
  EXPECT_FALSE(none->answers) << "nothing is kept";
  fetch.now();
  EXPECT_FALSE(broadphase.take(*none));
  broadphase.update(first.view(), dyb.view(), 0.02);
  const auto doubtful = guess(first);
  EXPECT_FALSE(doubtful->answers) << "it was searched anew: what was kept did not serve";
  fetch.now();
  broadphase.update(first.view(), dyb.view(), 0.02);
  for (Vec3& p : y) p += test::random_vec(r, 1e-6);
  const Buffer<Vec3> near(y);
  auto one = guess(near);
  ASSERT_TRUE(one->answers);
  fetch.now();
  ASSERT_TRUE(broadphase.take(*one));
  expect_exact(s, broadphase, brute_force(s, y, dy, 0.02));
  auto late = guess(near);
  for (Vec3& p : y) p += test::random_vec(r, 0.1);
  const Buffer<Vec3> far(y);
  auto wrong = guess(far);
  fetch.now();
  EXPECT_FALSE(broadphase.take(*wrong));
  auto found = broadphase.search(far.view(), dyb.view(), *wrong, {}, fetch);
  fetch.now();
  ASSERT_NE(found, nullptr);
  EXPECT_TRUE(broadphase.take(*found)) << "it was searched for this question";
  EXPECT_FALSE(broadphase.take(*late)) << "another list is kept by now";
  expect_exact(s, broadphase, brute_force(s, y, dy, 0.02));
}

// Where everything lies on the way of everything, ways are shortened until few enough pairs are left, and those are exact; those of another
// environment, as long as the scene too, stay as they are.
TEST(Broadphase, ShortensWaysOnWhichTooMuchLies) {
  test::Random r(41);
  test::Soup s;
  for (int b = 0; b < 2; ++b) test::add_patch(s, r, 14, 1, test::random_vec(r, 0.3), 0);
  for (int b = 0; b < 2; ++b) test::add_patch(s, r, 4, 1, test::random_vec(r, 0.3), 1);
  s.allowed.assign(s.bodies * s.bodies, 1);
  for (int b = 0; b < s.bodies; ++b) s.allowed[b * s.bodies + b] = 0;
  const Surface surface = s.surface();
  Broadphase broadphase(surface);
  std::vector<Vec3> dy(s.points.size());
  for (std::size_t i = 0; i < dy.size(); ++i) dy[i] = test::random_vec(r, s.env[i] == 0 ? 1e7 : 1);
  const Buffer<Vec3> y(s.points);
  Buffer<Vec3> way(dy);
  device::Fetch fetch;
  const auto guess = broadphase.guess(y.view(), std::as_const(way).view(), 0.02, {}, fetch);
  fetch.now();
  ASSERT_FALSE(broadphase.take(*guess));
  const auto shorten = [&](const std::vector<double>& by) {
    for (std::size_t i = 0; i < dy.size(); ++i) dy[i] *= by[s.env[i]];
    way.upload(dy);
  };
  const std::vector<Vec3> whole = dy;
  ASSERT_EQ(broadphase.search(y.view(), std::as_const(way).view(), *guess, shorten, fetch), nullptr);
  const auto few = [&](const BruteForce& found) {
    const auto mine = [&](Index point) { return s.env[point] == 0; };
    const auto pairs = std::count_if(found.pt.begin(), found.pt.end(), [&](const auto& p) { return mine(p[0]); }) +
                       std::count_if(found.ee.begin(), found.ee.end(), [&](const auto& p) { return mine(s.edges[p[0]].v[0]); });
    const auto queries = std::count_if(s.env.begin(), s.env.end(), [](Index e) { return e == 0; }) +
                         std::count_if(s.edges.begin(), s.edges.end(), [&](const Edge& e) { return mine(e.v[0]); });
    return pairs <= std::max<double>(tuning::kFewPairs, tuning::kPairsEach * queries);
  };
  const BruteForce truth = brute_force(s, s.points, dy, 0.02);
  expect_exact(s, broadphase, truth);
  EXPECT_TRUE(few(truth));
  std::vector<Vec3> twice = dy;
  for (std::size_t i = 0; i < dy.size(); ++i) {
    twice[i] *= 2;
    if (s.env[i] == 1) EXPECT_EQ(dy[i], whole[i]);
  }
  EXPECT_FALSE(few(brute_force(s, s.points, twice, 0.02))) << "shorter than need be";
}

// Environments are asked for together and by turns, and one of them moves far each time: it alone is searched again.
TEST(Broadphase, KeepsAListOfEveryEnvironment) {
  constexpr Index kEnvs = 4, kPasses = 24;
  const test::Soup s = many_bodies(9, kEnvs, 4, 29, true);
  const Surface surface = s.surface();
  Broadphase broadphase(surface);
  test::Random r(31);
  std::vector<Vec3> y = s.points, dy(y.size());
  NearPairs all;
  for (Index pass = 0; pass < kPasses; ++pass) {
    const Index jumps = pass % kEnvs;
    std::vector<std::uint8_t> whose(kEnvs, 1);
    if (pass % 4 == 1 || pass % 4 == 2) whose[(pass / 4) % kEnvs] = 0;
    if (pass % 8 == 7) whose.assign(kEnvs, 0), whose[jumps] = 1;
    if (pass % 4 == 0) whose.clear();
    // Its way is longer than what a search may find in excess, or just the start of short ones.
    for (std::size_t i = 0; i < dy.size(); ++i) dy[i] = test::random_vec(r, s.env[i] == jumps ? (pass % 2 ? 0.2 : 4e-3) : 1e-7);
    const Buffer<Vec3> yb(y), dyb(dy);
    broadphase.update(yb.view(), dyb.view(), 0.02, whose);
    BruteForce truth = brute_force(s, y, dy, 0.02);
    const auto left_out = [&](Index point) { return !whose.empty() && !whose[s.env[point]]; };
    std::erase_if(truth.pt, [&](const auto& p) { return left_out(p[0]); });
    std::erase_if(truth.ee, [&](const auto& p) { return left_out(s.edges[p[0]].v[0]); });
    ASSERT_FALSE(truth.ee.empty());
    expect_exact(s, broadphase, truth);
    // What is kept elsewhere of the others stays as it is.
    std::vector<Index> before = all.ee_env_offset, now;
    broadphase.copy(whose, all);
    for (Index e = 0; e < kEnvs; ++e) {
      const bool asked = whose.empty() || whose[e];
      const std::vector<Index>& from = asked ? broadphase.ee_env_offset() : before;
      EXPECT_EQ(all.ee_env_offset[e + 1] - all.ee_env_offset[e], from.empty() ? 0 : from[e + 1] - from[e]) << e;
    }
    for (std::size_t i = 0; i < y.size(); ++i)
      y[i] += !left_out(static_cast<Index>(i)) ? dy[i] : pass % 4 == 1 ? test::random_vec(r, 0.05) : Vec3(0, 0, 0);
  }
  // All at first, then mostly the one that moves and the one that has moved.
  EXPECT_LT(broadphase.searches(), 11 * kPasses / 4);
}

TEST(Broadphase, DoesNotDependOnThreads) {
  const test::Soup s = many_bodies(12, 4, 10, 3, true);
  const Surface surface = s.surface();
  const Buffer<Vec3> y(s.points);
  std::vector<std::vector<PointTriangle>> pt;
  std::vector<std::vector<EdgeEdge>> ee;
  for (int threads : {1, 2, 5}) {
    device::set_threads(threads);
    Broadphase b(surface);
    b.update(y.view(), {}, 0.03);
    pt.push_back(test::download(b.point_triangles()));
    ee.push_back(test::download(b.edge_edges()));
  }
  device::set_threads(0);
  for (int k : {1, 2}) {
    ASSERT_EQ(pt[k].size(), pt[0].size());
    ASSERT_EQ(ee[k].size(), ee[0].size());
    EXPECT_EQ(0, std::memcmp(pt[k].data(), pt[0].data(), pt[0].size() * sizeof(PointTriangle)));
    EXPECT_EQ(0, std::memcmp(ee[k].data(), ee[0].data(), ee[0].size() * sizeof(EdgeEdge)));
  }
}

// What a query's walkers find, one after the other, as bits of the walker that found it: how often, and by whom.
std::vector<std::uint64_t> walked(const Surface& surface, const Bvh& tree, View<const Vec3> y, Index parts) {
  const SurfaceView s = surface.view();
  const BvhView t = tree.view();
  Buffer<std::uint64_t> found(s.edges.n * s.triangles.n);
  found.zero();
  const View<std::uint64_t> out = found.view();
  device::parallel_for("test.walk", s.edges.n, [=] MORTISE_HD(Index e) {
    const BvhNode box = swept_box(s.edges[e].v, 2, -1, s, y, {}, 0.05);
    for (Index part = 0; part < parts; ++part) {
      BvhCursor cursor{part, parts};
      for (Index k = cursor.next(t, box, s); k >= 0; k = cursor.next(t, box, s)) out[e * s.triangles.n + k] += std::uint64_t{1} << 2 * part;
    }
  });
  return found.download();
}

// Walkers that share a walk find what one finds, each of it once, and none of them nearly everything.
TEST(Bvh, WalkersShareOutWhatIsThere) {
  for (int squares : {1, 2, 12}) {  // trees of one level and more
    const test::Soup s = many_bodies(4, 2, squares, 21, true);
    const Surface surface = s.surface();
    const Buffer<Vec3> y(s.points);
    Bvh tree;
    const SurfaceView v = surface.view();
    tree.update({v.triangles.p->v, v.triangles.n, 3}, v, 2, y.view(), {});
    const std::vector<std::uint64_t> alone = walked(surface, tree, y.view(), 1);
    const auto all = std::count(alone.begin(), alone.end(), 1u);
    ASSERT_GT(all, 0);
    for (Index parts : {2, 8, 32}) {
      const std::vector<std::uint64_t> shared = walked(surface, tree, y.view(), parts);
      std::vector<std::ptrdiff_t> of(parts, 0);
      for (std::size_t i = 0; i < alone.size(); ++i) {
        ASSERT_EQ(shared[i] != 0, alone[i] != 0) << i;
        for (Index part = 0; part < parts; ++part)
          if (shared[i] == std::uint64_t{1} << 2 * part) ++of[part];
      }
      EXPECT_EQ(std::accumulate(of.begin(), of.end(), std::ptrdiff_t{0}), all);  // each of one walker, once
      if (squares == 12) EXPECT_LT(*std::max_element(of.begin(), of.end()), 2 * all / parts);
    }
  }
}

TEST(Broadphase, EmptyCases) {
  const Surface nothing;
  Broadphase none(nothing);
  none.update({}, {}, 0.1);
  EXPECT_EQ(none.point_triangles().n, 0);
  EXPECT_EQ(none.edge_edges().n, 0);

  // Soft interior points only: nothing collides, but the environments are still there.
  test::Soup s;
  s.add_body({Vec3(0, 0, 0), Vec3(1, 0, 0)}, {}, 0);
  s.add_body({Vec3(0, 0, 0)}, {}, 1);
  s.allowed = {1, 1, 1, 1};
  const Surface points = s.surface();
  const Buffer<Vec3> y(s.points);
  Broadphase b(points);
  b.update(y.view(), {}, 0.1);
  EXPECT_EQ(b.pt_env_offset(), (std::vector<Index>{0, 0, 0}));
  EXPECT_EQ(b.ee_env_offset(), (std::vector<Index>{0, 0, 0}));

  // Two bodies far apart, and then the same bodies close together.
  test::Soup two;
  two.add_body({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {{{0, 1, 2}}}, 0);
  two.add_body({Vec3(0, 0, 5), Vec3(1, 0, 5), Vec3(0, 1, 5)}, {{{0, 1, 2}}}, 0);
  two.allowed = {0, 1, 1, 0};
  const Surface pair = two.surface();
  Broadphase p(pair);
  const Buffer<Vec3> apart(two.points);
  p.update(apart.view(), {}, 0.1);
  EXPECT_EQ(p.point_triangles().n, 0);
  const Buffer<Vec3> dy(std::vector<Vec3>{Vec3(0, 0, 5), Vec3(0, 0, 5), Vec3(0, 0, 5), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()});
  p.update(apart.view(), dy.view(), 0);
  EXPECT_EQ(p.point_triangles().n, 6);
  EXPECT_EQ(p.edge_edges().n, 9);
}

}  // namespace
}  // namespace mortise::geometry
