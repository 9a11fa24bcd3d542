#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <filesystem>
#include <functional>

#include "geometry/io/obj.h"
#include "geometry/io/read.h"
#include "geometry/primitives.h"
#include "geometry/shapes.h"
#include "geometry/tetrahedralise.h"
#include "geometry/tetrahedralise_cache.h"
#include "geometry/topology.h"
#include "geometry/topology_check.h"
#include "mesh_helpers.h"

namespace mortise::geometry {
namespace {

TetrahedraliseOptions edges(double inner, double surface = 0) {
  TetrahedraliseOptions o;
  o.edge_length = inner;
  o.surface_edge_length = surface;
  return o;
}

double mean_edge(const TriMesh& s) {
  double sum = 0;
  const std::vector<Edge> e = unique_edges(s.triangles);
  for (const Edge& x : e) sum += (s.points[x.v[0]] - s.points[x.v[1]]).norm();
  return sum / static_cast<double>(e.size());
}

// Mean over the edges that leave the surface.
double mean_inner_edge(const TetMesh& m) {
  std::vector<char> on_surface(m.points.size(), 0);
  for (const Triangle& t : boundary_triangles(m))
    for (Index v : t.v) on_surface[v] = 1;
  std::vector<Triangle> faces;
  for (const Tet& t : m.tets)
    for (int k = 0; k < 4; ++k) faces.push_back({{t.v[k], t.v[(k + 1) % 4], t.v[(k + 2) % 4]}});
  double sum = 0;
  int count = 0;
  for (const Edge& e : unique_edges(faces)) {
    if (on_surface[e.v[0]] && on_surface[e.v[1]]) continue;
    sum += (m.points[e.v[0]] - m.points[e.v[1]]).norm();
    ++count;
  }
  return sum / count;
}

TEST(Tetrahedralise, BallMeetsItsAims) {
  const ScopedEnv no_cache("MORTISE_CACHE", "");
  const TriMesh s = surface_of(sphere(1e-2, 5e-4));
  const TetMesh m = tetrahedralise(s, edges(2e-3), "ball");
  EXPECT_NO_THROW(check_tets(m, "ball"));
  EXPECT_GT(min_dihedral_angle(m), 11.9 * M_PI / 180);
  EXPECT_NEAR(mean_edge(surface_of(m)) / 2e-3, 1, 0.1);
  EXPECT_NEAR(mean_inner_edge(m) / 2e-3, 1, 0.1);
  EXPECT_NEAR(volume(m) / mass_properties(s).volume, 1, 0.02);
  EXPECT_NO_THROW(check_closed_surface(surface_of(m), "surface of the ball"));
}

TEST(Tetrahedralise, SurfaceCanBeFiner) {
  const ScopedEnv no_cache("MORTISE_CACHE", "");
  const TetMesh m = tetrahedralise(surface_of(sphere(1, 0.1)), edges(0.5, 0.25), "ball");
  EXPECT_NEAR(mean_edge(surface_of(m)) / 0.25, 1, 0.15);
  EXPECT_GT(mean_inner_edge(m), 0.3);
}

TEST(Tetrahedralise, SharpEdgesStay) {
  const ScopedEnv no_cache("MORTISE_CACHE", "");
  const Vec3 size(1, 0.6, 0.3);
  const TetMesh m = tetrahedralise(surface_of(box(size, 1.0)), edges(0.1), "box");
  EXPECT_NEAR(volume(m), 0.18, 1e-12);
  EXPECT_NEAR(area(surface_of(m)), 2 * (0.6 + 0.3 + 0.18), 1e-12);
  EXPECT_NEAR(mean_edge(surface_of(m)) / 0.1, 1, 0.15);
}

// Of around x across quads, cut in two.
TriMesh ring(double radius, double thickness, Index around, Index across) {
  TriMesh out;
  for (Index i = 0; i < around; ++i)
    for (Index k = 0; k < across; ++k) {
      const double u = 2 * M_PI * i / around, v = 2 * M_PI * k / across, r = radius + thickness / 2 * std::cos(v);
      out.points.push_back({r * std::cos(u), r * std::sin(u), thickness / 2 * std::sin(v)});
      const Index a = i * across + k, b = (i + 1) % around * across + k, c = i * across + (k + 1) % across,
                  d = (i + 1) % around * across + (k + 1) % across;
      out.triangles.push_back({{a, b, d}});
      out.triangles.push_back({{a, d, c}});
    }
  return out;
}

// Ten points to begin with, as CGAL has them, are too far from each other to see that there is an inside.
TEST(Tetrahedralise, FindsTheInsideOfAThinRing) {
  const ScopedEnv no_cache("MORTISE_CACHE", "");
  for (const double thickness : {4e-3, 2e-3}) {
    const TriMesh s = ring(15e-3, thickness, thickness < 3e-3 ? 96 : 48, 16);
    const TetMesh m = tetrahedralise(s, edges(thickness / 2), "ring");
    EXPECT_NO_THROW(check_tets(m, "ring"));
    EXPECT_EQ(component_count(connected_components(surface_of(m))), 1);
    EXPECT_NEAR(volume(m) / (M_PI * thickness * thickness / 4 * 2 * M_PI * 15e-3), 1, 0.25);
  }
}

// Half a ball on a cylinder; moving points away from slivers ends in a failed assertion of CGAL's there.
TriMesh dome(Index around, Index up) {
  constexpr double R = 8e-3, h = 4e-3;
  std::vector<std::pair<double, double>> profile;  // r, z
  for (int k = 1; k <= 4; ++k) profile.push_back({R * k / 4, 0});
  for (int k = 1; k <= 4; ++k) profile.push_back({R, h * k / 4});
  for (Index k = 1; k < up; ++k) profile.push_back({R * std::cos(M_PI / 2 * k / up), h + R * std::sin(M_PI / 2 * k / up)});
  TriMesh out;
  out.points.push_back({0, 0, 0});
  for (const auto& [r, z] : profile)
    for (Index k = 0; k < around; ++k) out.points.push_back({r * std::cos(2 * M_PI * k / around), r * std::sin(2 * M_PI * k / around), z});
  out.points.push_back({0, 0, h + R});
  const Index rings = static_cast<Index>(profile.size()), top = static_cast<Index>(out.points.size()) - 1;
  for (Index k = 0; k < around; ++k) {
    const Index next = (k + 1) % around;
    out.triangles.push_back({{0, 1 + next, 1 + k}});
    for (Index i = 0; i + 1 < rings; ++i) {
      const Index a = 1 + i * around + k, b = 1 + i * around + next;
      out.triangles.push_back({{a, b, b + around}});
      out.triangles.push_back({{a, b + around, a + around}});
    }
    out.triangles.push_back({{1 + (rings - 1) * around + k, 1 + (rings - 1) * around + next, top}});
  }
  return out;
}

TEST(Tetrahedralise, SurvivesAssertionsOfItsLibrary) {
  const ScopedEnv no_cache("MORTISE_CACHE", "");
  for (const double edge : {1e-3, 1.2e-3}) {
    const TetMesh m = tetrahedralise(dome(96, 24), edges(edge), "dome");
    EXPECT_NO_THROW(check_tets(m, "dome"));
    EXPECT_NEAR(volume(m) / (M_PI * 8e-3 * 8e-3 * (4e-3 + 2.0 / 3 * 8e-3)), 1, 0.02);
  }
}

TEST(Tetrahedralise, KeepsCavitiesAndParts) {
  const ScopedEnv no_cache("MORTISE_CACHE", "");
  TriMesh s = surface_of(box({1, 1, 1}, 1.0));
  const TriMesh inner = surface_of(box({0.4, 0.4, 0.4}, 1.0)), apart = surface_of(box({0.5, 0.5, 0.5}, 1.0));
  for (const Vec3& p : inner.points) s.points.push_back(p);
  for (const Vec3& p : apart.points) s.points.push_back(p + Vec3(2, 0, 0));
  for (const Triangle& t : inner.triangles) s.triangles.push_back({{t.v[0] + 8, t.v[2] + 8, t.v[1] + 8}});
  for (const Triangle& t : apart.triangles) s.triangles.push_back({{t.v[0] + 16, t.v[1] + 16, t.v[2] + 16}});
  const TetMesh m = tetrahedralise(s, edges(0.2), "parts");
  EXPECT_NEAR(volume(m), 1 - 0.064 + 0.125, 1e-12);
  EXPECT_EQ(component_count(connected_components(surface_of(m))), 3);
}

TEST(Tetrahedralise, SameInputSameBits) {
  const ScopedEnv no_cache("MORTISE_CACHE", "");
  const TriMesh s = surface_of(capsule(0.1, 0.2, 0.02));
  const TetMesh a = tetrahedralise(s, edges(0.05), "a"), b = tetrahedralise(s, edges(0.05), "b");
  expect_same(a.points, b.points);
  expect_same(a.tets, b.tets);
}

TEST(Tetrahedralise, Refuses) {
  const ScopedEnv no_cache("MORTISE_CACHE", "");
  const TriMesh s = surface_of(box({1, 1, 1}, 1.0));
  TriMesh open = s;
  open.triangles.pop_back();
  expect_error([&] { tetrahedralise(open, edges(0.2), "mesh 'o'"); }, Exit::scene, {"mesh 'o': the surface is open"});
  expect_error([&] { tetrahedralise(s, edges(0), "mesh 'o'"); }, Exit::scene, {"mesh 'o'", "positive"});
  expect_error([&] { tetrahedralise(s, edges(1e-4), "mesh 'o'"); }, Exit::scene,
               {"it is 1 m x 1 m x 1 m, far too large to be filled at an edge_length of 0.0001 m", "add 'scale: 0.001'"});
  // A far coarser aim than the body: what comes out is no longer the body.
  TetrahedraliseOptions coarse = edges(5);
  coarse.facet_distance = 1;
  expect_error([&] { tetrahedralise(surface_of(sphere(1, 0.1)), coarse, "mesh 'o'"); }, Exit::scene, {"use a smaller edge_length"});
}

// What edges(0.4) becomes before it is hashed.
TetrahedraliseOptions filled_in() {
  TetrahedraliseOptions full = edges(0.4, 0.4);
  full.facet_distance = 0.4 / 20;
  return full;
}

TEST(TetCache, HitGivesTheStoredMesh) {
  const TempFolder folder;
  const ScopedEnv cache("MORTISE_CACHE", folder.file("sub/cache"));
  const TriMesh s = surface_of(box({1, 1, 1}, 1.0));
  const TetCache entry(s, filled_in());
  EXPECT_FALSE(entry.load());
  const TetMesh fresh = tetrahedralise(s, edges(0.4), "box");
  ASSERT_TRUE(std::filesystem::exists(entry.file())) << "defaults are filled in before hashing";
  const TetMesh again = tetrahedralise(s, edges(0.4), "box");
  expect_same(fresh.points, again.points);
  expect_same(fresh.tets, again.tets);

  // Something else in the file shows that it is really read.
  const TetMesh mark = box({1, 1, 1}, 1.0);
  entry.store(mark);
  EXPECT_EQ(tetrahedralise(s, edges(0.4), "box").tets.size(), mark.tets.size());
  int files = 0;
  for ([[maybe_unused]] const auto& f : std::filesystem::directory_iterator(folder.file("sub/cache"))) ++files;
  EXPECT_EQ(files, 1) << "nothing is left beside it";
}

TEST(TetCache, EveryInputCounts) {
  const ScopedEnv cache("MORTISE_CACHE", "/nowhere");
  const TriMesh s = surface_of(box({1, 1, 1}, 1.0));
  std::vector<std::string> names{TetCache(s, edges(0.4)).file()};
  TriMesh moved = s;
  moved.points[3][2] = std::nextafter(moved.points[3][2], 9);
  names.push_back(TetCache(moved, edges(0.4)).file());
  names.push_back(TetCache(s, edges(0.5)).file());
  names.push_back(TetCache(s, edges(0.4, 0.2)).file());
  for (double TetrahedraliseOptions::*member : {&TetrahedraliseOptions::facet_distance, &TetrahedraliseOptions::feature_angle,
                                                &TetrahedraliseOptions::facet_angle, &TetrahedraliseOptions::radius_edge_ratio}) {
    TetrahedraliseOptions o = edges(0.4);
    o.*member += 0.01;
    names.push_back(TetCache(s, o).file());
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::unique(names.begin(), names.end()), names.end());
}

TEST(TetCache, DamagedFilesAreMadeAnew) {
  const TempFolder folder;
  const ScopedEnv cache("MORTISE_CACHE", folder.file(""));
  const TriMesh s = surface_of(box({1, 1, 1}, 1.0));
  const TetCache entry(s, edges(0.4));
  const TetMesh mesh = box({1, 1, 1}, 0.5);
  entry.store(mesh);
  ASSERT_TRUE(entry.load());
  expect_same(entry.load()->points, mesh.points);
  const auto size = std::filesystem::file_size(entry.file());

  std::filesystem::resize_file(entry.file(), size - 100);
  EXPECT_FALSE(entry.load());
  entry.store(mesh);
  {
    std::fstream f(entry.file(), std::ios::in | std::ios::out | std::ios::binary);
    f.seekp(static_cast<std::streamoff>(size / 2));
    f.put('\x55');
  }
  EXPECT_FALSE(entry.load());
  std::ofstream(entry.file()) << "short";
  EXPECT_FALSE(entry.load());
}

// The checksum is right, since store() computes it: what it was computed of is not a mesh.
TEST(TetCache, SoundChecksumsOfNonsenseAreMadeAnew) {
  const TempFolder folder;
  const ScopedEnv cache("MORTISE_CACHE", folder.file(""));
  const TriMesh s = surface_of(box({1, 1, 1}, 1.0));
  const TetCache entry(s, filled_in());
  const TetMesh good = box({1, 1, 1}, 0.5);
  const auto refused = [&](const char* what, const std::function<void(TetMesh&)>& spoil) {
    TetMesh mesh = good;
    spoil(mesh);
    entry.store(mesh);
    EXPECT_FALSE(entry.load()) << what;
    EXPECT_GT(tetrahedralise(s, edges(0.4), "box").tets.size(), 40u) << what << ": made again, and stored";
    EXPECT_TRUE(entry.load()) << what;
  };
  refused("a node that does not exist", [](TetMesh& m) { m.tets[3].v[1] = static_cast<Index>(m.points.size()); });
  refused("a negative node", [](TetMesh& m) { m.tets[3].v[1] = -1; });
  refused("an inverted tetrahedron", [](TetMesh& m) { std::swap(m.tets[0].v[0], m.tets[0].v[1]); });
  refused("a flat tetrahedron", [](TetMesh& m) { m.tets[0].v[0] = m.tets[0].v[1]; });
  refused("a point that is not finite", [](TetMesh& m) { m.points[2][1] = NAN; });
  refused("no tetrahedra", [](TetMesh& m) { m.tets.clear(); });
}

TEST(TetCache, WhatIsNoFileIsNotWaitedFor) {
  const TempFolder folder;
  const ScopedEnv cache("MORTISE_CACHE", folder.file(""));
  const TetCache entry(surface_of(box({1, 1, 1}, 1.0)), edges(0.4));
  ASSERT_EQ(::mkfifo(entry.file().c_str(), 0600), 0);
  EXPECT_FALSE(entry.load());
}

TEST(TetCache, FolderThatCannotBeWrittenIsIgnored) {
  const TempFolder folder;
  const ScopedEnv cache("MORTISE_CACHE", folder.write("file", "") + "/below");
  const TriMesh s = surface_of(box({1, 1, 1}, 1.0));
  EXPECT_NO_THROW(TetCache(s, edges(0.4)).store(box({1, 1, 1}, 1.0)));
  EXPECT_FALSE(TetCache(s, edges(0.4)).load());
}

TEST(TetCache, FolderFollowsTheEnvironment) {
  const TriMesh s = surface_of(box({1, 1, 1}, 1.0));
  const ScopedEnv home("HOME", "/h"), xdg("XDG_CACHE_HOME", "/x");
  {
    const ScopedEnv off("MORTISE_CACHE", "");
    EXPECT_EQ(TetCache(s, edges(1)).file(), "");
  }
  {
    const ScopedEnv own("MORTISE_CACHE", "/m");
    EXPECT_EQ(TetCache(s, edges(1)).file().rfind("/m/tets-", 0), 0u);
    ::unsetenv("MORTISE_CACHE");
    EXPECT_EQ(TetCache(s, edges(1)).file().rfind("/x/mortise/tets-", 0), 0u);
    ::setenv("XDG_CACHE_HOME", "", 1);
    EXPECT_EQ(TetCache(s, edges(1)).file().rfind("/h/.cache/mortise/tets-", 0), 0u);
  }
}

}  // namespace
}  // namespace mortise::geometry
