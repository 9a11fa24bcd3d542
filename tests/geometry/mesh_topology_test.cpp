#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "geometry/hull.h"
#include "geometry/primitives.h"
#include "geometry/topology.h"
#include "geometry/topology_check.h"
#include "mesh_helpers.h"

namespace mortise::geometry {
namespace {

TetMesh one_tet() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{{0, 1, 2, 3}}}}; }

TriMesh cube(const Vec3& at = Vec3::Zero(), double side = 1) {
  TriMesh s = surface_of(box({side, side, side}, std::array<Index, 3>{1, 1, 1}));
  for (Vec3& p : s.points) p += at;
  return s;
}

TriMesh joined(TriMesh a, const TriMesh& b) {
  const Index n = static_cast<Index>(a.points.size());
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  for (const Triangle& t : b.triangles) a.triangles.push_back({{t.v[0] + n, t.v[1] + n, t.v[2] + n}});
  return a;
}

TEST(Topology, FacesOfOneTetPointOutward) {
  const TetMesh m = one_tet();
  const std::vector<Triangle> faces = boundary_triangles(m);
  ASSERT_EQ(faces.size(), 4u);
  const Vec3 inside(0.1, 0.1, 0.1);
  for (const Triangle& t : faces) {
    const Vec3 &a = m.points[t.v[0]], &b = m.points[t.v[1]], &c = m.points[t.v[2]];
    EXPECT_LT((b - a).cross(c - a).dot(inside - a), 0);
  }
}

TEST(Topology, SurfaceDropsInnerPointsAndRemembersTheirSource) {
  const TetMesh m = box({1, 1, 1}, std::array<Index, 3>{3, 3, 3});
  std::vector<Index> source;
  const TriMesh s = surface_of(m, &source);
  EXPECT_EQ(s.points.size(), 64u - 8);
  EXPECT_EQ(s.triangles.size(), 6u * 9 * 2);
  ASSERT_EQ(source.size(), s.points.size());
  for (std::size_t i = 0; i < source.size(); ++i) {
    EXPECT_EQ(m.points[source[i]], s.points[i]);
    if (i > 0) {
      EXPECT_LT(source[i - 1], source[i]);
    }
  }
  EXPECT_EQ(without_unused_points(TetMesh{m.points, {m.tets[0]}}).points.size(), 4u);
}

TEST(Topology, EdgesAreUniqueAndSorted) {
  const std::vector<Edge> e = unique_edges(cube().triangles);
  ASSERT_EQ(e.size(), 18u);
  for (std::size_t i = 0; i < e.size(); ++i) {
    EXPECT_LT(e[i].v[0], e[i].v[1]);
    if (i > 0) {
      EXPECT_LT(std::pair(e[i - 1].v[0], e[i - 1].v[1]), std::pair(e[i].v[0], e[i].v[1]));
    }
  }
}

TEST(Topology, WeightsAreThirdsOfAreas) {
  const TetMesh m = one_tet();
  const std::vector<Triangle> t = boundary_triangles(m);
  const double right = 0.5, slanted = std::sqrt(3.0) / 2;
  const std::vector<double> w = vertex_areas(m.points, t);
  EXPECT_NEAR(w[0], 3 * right / 3, 1e-15);
  EXPECT_NEAR(w[1], (2 * right + slanted) / 3, 1e-15);
  const std::vector<Edge> edges = unique_edges(t);
  const std::vector<double> we = edge_areas(m.points, t, edges);
  EXPECT_NEAR(we[0], 2 * right / 3, 1e-15);          // 0-1
  EXPECT_NEAR(we[5], (right + slanted) / 3, 1e-15);  // 2-3
  EXPECT_NEAR(std::accumulate(we.begin(), we.end(), 0.0), 3 * right + slanted, 1e-15);
}

TEST(Topology, MassOfABoxIsExact) {
  TriMesh s = surface_of(box({2, 3, 5}, 1.0));
  const Vec3 shift(100, -40, 7);
  for (Vec3& p : s.points) p += shift;
  const MassProperties m = mass_properties(s);
  EXPECT_NEAR(m.volume, 30, 1e-11);
  EXPECT_NEAR((m.centroid - shift).norm(), 0, 1e-12);
  // int X1^2 dV = V a^2/12
  const Mat3 second = Vec3(30 * 4 / 12.0, 30 * 9 / 12.0, 30 * 25 / 12.0).asDiagonal();
  EXPECT_NEAR((m.second_moment - second).norm(), 0, 1e-10);
  const Mat3 inertia = 2.0 * 30 / 12 * Vec3(9 + 25, 4 + 25, 4 + 9).asDiagonal().toDenseMatrix();
  EXPECT_NEAR((m.inertia(2) - inertia).norm(), 0, 1e-9);
}

TEST(Topology, MassFollowsARotation) {
  TriMesh s = surface_of(box({1, 2, 3}, 1.0));
  const Mat3 second = mass_properties(s).second_moment;
  const Mat3 r = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  for (Vec3& p : s.points) p = r * p;
  EXPECT_NEAR((mass_properties(s).second_moment - r * second * r.transpose()).norm(), 0, 1e-13);
}

// The inscribed polyhedron's inertia approaches 2/5 m r^2 with the square of the edge length.
TEST(Topology, InertiaOfASphereConverges) {
  const double exact = 0.4 * (4.0 / 3 * M_PI);
  double error[2];
  for (int k = 0; k < 2; ++k) {
    const MassProperties m = mass_properties(surface_of(sphere(1, k == 0 ? 0.125 : 0.0625)));
    EXPECT_NEAR(m.centroid.norm(), 0, 1e-14);
    const Mat3 j = m.inertia(1);
    EXPECT_NEAR((j - j(0, 0) * Mat3::Identity()).norm(), 0, 1e-13);
    error[k] = exact - j(0, 0);
  }
  EXPECT_GT(error[1], 0);
  EXPECT_LT(error[1], 0.01 * exact);
  EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.05);
}

TEST(Topology, CavityCountsNegative) {
  TriMesh hole = cube({0, 0, 0}, 1);
  for (Triangle& t : hole.triangles) std::swap(t.v[1], t.v[2]);
  const TriMesh shell = joined(cube({0, 0, 0}, 3), hole);
  EXPECT_NEAR(mass_properties(shell).volume, 26, 1e-13);
  EXPECT_EQ(component_count(connected_components(shell)), 2);
  EXPECT_NO_THROW(check_closed_surface(shell, "shell"));
}

TEST(Topology, ComponentsAreNumberedByFirstPoint) {
  TriMesh s = joined(cube(), cube({5, 0, 0}));
  s.points.push_back({9, 9, 9});
  const std::vector<Index> c = connected_components(s);
  EXPECT_EQ(c[0], 0);
  EXPECT_EQ(c[7], 0);
  EXPECT_EQ(c[8], 1);
  EXPECT_EQ(c[16], -1);
  EXPECT_EQ(component_count(c), 2);
}

TEST(MeshCheck, AcceptsSoundMeshes) {
  EXPECT_NO_THROW(check_closed_surface(cube(), "cube"));
  EXPECT_NO_THROW(check_closed_surface(joined(cube(), cube({2, 0, 0})), "two cubes"));
  EXPECT_NO_THROW(check_closed_surface(surface_of(capsule(1, 1, 0.2)), "capsule"));
  EXPECT_NO_THROW(check_tets(sphere(1e-3, 2e-4), "ball"));
}

void expect_refused(const TriMesh& s, const std::vector<std::string>& words) {
  expect_error([&] { check_closed_surface(s, "part 'x'"); }, Exit::scene, words);
}

TEST(MeshCheck, OpenSurface) {
  TriMesh s = cube();
  const Triangle t = s.triangles.back();
  s.triangles.pop_back();
  const std::pair e = std::minmax({t.v[0], t.v[1], t.v[2]});
  expect_refused(s, {"part 'x': the surface is open: 3 edges belong to one triangle only, the first is edge " + std::to_string(e.first) + "-",
                     "(8 points, 11 triangles)"});
}

TEST(MeshCheck, NonManifoldEdge) {
  // Two cubes that share four points of an edge pair: the shared edge has four triangles.
  TriMesh s = joined(cube(), cube({1, 1, 0}));
  for (Triangle& t : s.triangles)
    for (Index& v : t.v)
      for (Index w = 0; w < v; ++w)
        if (s.points[w] == s.points[v]) v = w;
  expect_refused(without_unused_points(s), {"the surface is not manifold: 1 edge belongs to more than two triangles", "(0.5, 0.5, 0) m"});
}

TEST(MeshCheck, NonManifoldVertex) {
  TriMesh s = joined(cube(), cube({1, 1, 1}));
  for (Triangle& t : s.triangles)
    for (Index& v : t.v)
      if (v >= 8 && s.points[v] == Vec3(0.5, 0.5, 0.5)) v = 7;
  expect_refused(s, {"at 1 vertex parts of it touch in a single point, the first is vertex 7 at (0.5, 0.5, 0.5) m"});
}

TEST(MeshCheck, Orientation) {
  TriMesh s = cube();
  std::swap(s.triangles[4].v[0], s.triangles[4].v[1]);
  expect_refused(s, {"not consistently oriented: across 3 edges"});
  s = cube();
  for (Triangle& t : s.triangles) std::swap(t.v[0], t.v[1]);
  expect_refused(s, {"inside out"});
}

TEST(MeshCheck, Triangles) {
  TriMesh s = cube();
  s.triangles.push_back(s.triangles[2]);
  expect_refused(s, {"1 triangle repeats the vertices of another, the first is triangle 12 (same as 2)"});
  s = cube();
  s.points[3] = s.points[1];
  expect_refused(s, {"no area, the first is triangle"});
  s = cube();
  s.triangles[5].v[1] = 8;
  expect_refused(s, {"element 5 refers to point 8, but there are 8 points"});
  s = cube();
  s.triangles.clear();
  expect_refused(s, {"there are no triangles"});
}

TEST(MeshCheck, Coordinates) {
  TriMesh s = cube();
  s.points[6][1] = std::nan("");
  expect_refused(s, {"1 point has a coordinate that is not a finite number, the first is point 6"});
  TetMesh m = one_tet();
  m.points[2][0] = INFINITY;
  expect_error([&] { check_tets(m, "m"); }, Exit::scene, {"point 2"});
}

TEST(MeshCheck, SelfIntersection) {
  const TriMesh s = joined(cube(), cube({0.5, 0.3, 0.2}));
  expect_refused(s, {"intersects itself in", "pairs of triangles"});
  EXPECT_FALSE(self_intersections(s).empty());
  EXPECT_TRUE(self_intersections(joined(cube(), cube({1.0 + 1e-15, 0, 0}))).empty()) << "a gap of a few ulp is a gap";
  EXPECT_FALSE(self_intersections(joined(cube(), cube({1.0, 0, 0}))).empty()) << "touching is not free";
  // A corner pushed through the opposite face: only neighbours of it intersect.
  TriMesh flap = cube();
  flap.points[7] = {0.2, 0.2, -0.9};
  expect_refused(flap, {"intersects itself"});
}

TEST(MeshCheck, Tets) {
  TetMesh m = box({1, 1, 1}, std::array<Index, 3>{2, 2, 2});
  std::swap(m.tets[9].v[0], m.tets[9].v[1]);
  expect_error([&] { check_tets(m, "m"); }, Exit::scene,
               {"m: 1 tetrahedron is inverted, the first is tetrahedron 9 at", "(27 points, 48 tetrahedra)"});

  m = one_tet();
  m.points[3] = {0.3, 0.3, 0};
  expect_error([&] { check_tets(m, "m"); }, Exit::scene, {"1 tetrahedron has no volume, the first is tetrahedron 0"});
  m.tets.clear();
  expect_error([&] { check_tets(m, "m"); }, Exit::scene, {"no tetrahedra"});

  // Two tetrahedra that share an edge only: their boundary is not a surface there.
  m = one_tet();
  m.points.insert(m.points.end(), {{0, -1, 0}, {0, 0, -1}});
  m.tets.push_back({{0, 1, 4, 5}});
  ASSERT_GT(tet_volume(m.points, m.tets[1]), 0);
  expect_error([&] { check_tets(m, "m"); }, Exit::scene, {"m: boundary: the surface is not manifold: 1 edge", "edge 0-1"});
}

TEST(ClosedSurface, PartsInsideOfOthersAreCavities) {
  const auto turned = [](TriMesh m) {
    for (Triangle& t : m.triangles) std::swap(t.v[1], t.v[2]);
    return m;
  };
  const TriMesh outer = cube(Vec3::Zero(), 1), inner = cube(Vec3::Zero(), 0.5), core = cube(Vec3::Zero(), 0.2), beside = cube(Vec3(3, 0, 0), 1);
  for (const TriMesh& good : {joined(outer, beside), joined(outer, turned(inner)), joined(joined(outer, turned(inner)), core)})
    EXPECT_EQ(first_wrongly_nested(good), -1);
  EXPECT_EQ(first_wrongly_nested(joined(outer, inner)), 12);
  EXPECT_EQ(first_wrongly_nested(joined(outer, turned(beside))), 12);
  EXPECT_EQ(first_wrongly_nested(joined(joined(outer, turned(inner)), turned(core))), 24);
  expect_error([&] { check_closed_surface(joined(outer, inner), "it"); }, Exit::scene, {"lies inside of another part"});
}

// Points of a box's edges and faces, off them by rounding, and corners twice: the exact hull has triangles without height.
TEST(Hull, HasNoTrianglesWithoutHeight) {
  const Vec3 size(0.1, 0.2, 0.3);
  std::vector<Vec3> points;
  double noise = 0.3;
  for (const Vec3& x : surface_of(box(size, 0.05)).points)
    for (int twice = 0; twice < 2; ++twice) {
      Vec3 y = x;
      for (double& c : y) c += 1e-12 * (noise = 3.9 * noise * (1 - noise));
      points.push_back(y);
    }
  const TriMesh hull = convex_hull(points);
  check_closed_surface(hull, "the hull");  // that none of its triangles has no area, among others
  EXPECT_NEAR(mass_properties(hull).volume, size.prod(), 1e-11);
  expect_error([&] { convex_hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}); }, Exit::scene, {"lie in a plane"});
}

}  // namespace
}  // namespace mortise::geometry
