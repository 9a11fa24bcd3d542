#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "geometry/io/msh.h"
#include "geometry/io/obj.h"
#include "geometry/primitives.h"
#include "geometry/shapes.h"
#include "geometry/topology.h"
#include "geometry/topology_check.h"
#include "mesh_helpers.h"

namespace mortise::geometry {
namespace {

Params shape(const std::string& kind, const std::vector<std::pair<std::string, double>>& numbers) {
  const SourceLoc at{"scene.yaml", 7, 5};
  Params p = Params::make_table(at), s = Params::make_table(at);
  for (const auto& [key, value] : numbers) p.set(key, Params::make_number(value, at));
  s.set(kind, p);
  return s;
}

Params mesh_shape(const std::string& file, std::vector<std::pair<std::string, double>> numbers = {}) {
  const SourceLoc at{"scene.yaml", 7, 5};
  Params p = Params::make_table(at), s = Params::make_table(at);
  p.set("file", Params::make_text(file, at));
  p.set("scale", Params::make_number(1, at));
  p.set("weld", Params::make_number(0, at));
  for (const auto& [key, value] : numbers) p.set(key, Params::make_number(value, at));
  s.set("mesh", p);
  return s;
}

TEST(Shapes, Primitives) {
  Params box_shape = shape("box", {{"edge_length", 0.5}});
  Params block = box_shape.at("box");
  block.set("size", Params::make_list({Params::make_number(1), Params::make_number(2), Params::make_number(3)}));
  box_shape.set("box", block);
  EXPECT_NEAR(volume(tet_shape(box_shape)), 6, 1e-12);
  expect_same(surface_shape(box_shape).points, surface_of(box({1, 2, 3}, 0.5)).points);
  expect_same(tet_shape(shape("sphere", {{"radius", 2}, {"edge_length", 0.5}})).points, sphere(2, 0.5).points);
  expect_same(tet_shape(shape("cylinder", {{"radius", 1}, {"height", 3}, {"edge_length", 0.5}})).points, cylinder(1, 3, 0.5).points);
  expect_same(tet_shape(shape("capsule", {{"radius", 1}, {"height", 3}, {"edge_length", 0.5}})).points, capsule(1, 3, 0.5).points);
  expect_error([&] { tet_shape(shape("cone", {{"edge_length", 1}})); }, Exit::scene, {"scene.yaml:7:5", "cone"});
  expect_error([&] { surface_shape(Params::make_table({"scene.yaml", 3, 1})); }, Exit::scene, {"scene.yaml:3:1", "exactly one"});
}

TEST(Shapes, TetsOfAFileAreUsedAsTheyAre) {
  const TempFolder folder;
  TetMesh m = sphere(10, 4);
  write_msh(folder.file("ball.msh"), m);
  const TetMesh t = tet_shape(mesh_shape(folder.file("ball.msh"), {{"scale", 1e-3}}));
  expect_same(t.tets, m.tets);
  EXPECT_EQ(t.points[0], Vec3(1e-3 * m.points[0]));
  EXPECT_EQ(surface_shape(mesh_shape(folder.file("ball.msh"))).points.size(), surface_of(m).points.size());

  std::swap(m.tets[5].v[0], m.tets[5].v[1]);
  write_msh(folder.file("bad.msh"), m);
  expect_error([&] { tet_shape(mesh_shape(folder.file("bad.msh"))); }, Exit::scene, {"scene.yaml:7:5: error: mesh '", "bad.msh'", "tetrahedron 5"});
}

TEST(Shapes, SurfacesAreCheckedThenFilledOrUsed) {
  const TempFolder folder;
  const ScopedEnv no_cache("MORTISE_CACHE", "");
  TriMesh s = surface_of(box({100, 100, 50}, 50.0));
  write_obj(folder.file("part.obj"), s);
  const Params stiff = mesh_shape(folder.file("part.obj"), {{"scale", 1e-3}});
  EXPECT_EQ(surface_shape(stiff).triangles.size(), s.triangles.size());
  EXPECT_NEAR(mass_properties(surface_shape(stiff)).volume, 5e-4, 1e-15);
  expect_error([&] { tet_shape(stiff); }, Exit::scene, {"scene.yaml:7:5", "needs edge_length"});
  const TetMesh coarse = tet_shape(mesh_shape(folder.file("part.obj"), {{"scale", 1e-3}, {"edge_length", 25e-3}}));
  EXPECT_NEAR(volume(coarse), 5e-4, 1e-15);
  const TetMesh fine = tet_shape(mesh_shape(folder.file("part.obj"), {{"scale", 1e-3}, {"edge_length", 25e-3}, {"surface_edge_length", 12e-3}}));
  EXPECT_GT(fine.points.size(), 2 * coarse.points.size());

  s.triangles.pop_back();
  write_obj(folder.file("open.obj"), s);
  expect_error([&] { surface_shape(mesh_shape(folder.file("open.obj"))); }, Exit::scene, {"scene.yaml:7:5: error: mesh '", "the surface is open"});
  expect_error([&] { tet_shape(mesh_shape(folder.file("open.obj"), {{"edge_length", 20}})); }, Exit::scene, {"scene.yaml:7:5", "open"});
  expect_error([&] { surface_shape(mesh_shape(folder.file("lost.obj"))); }, Exit::file, {"lost.obj"});
}

// The weld tolerance is a length in the scene, not in the file.
TEST(Shapes, WeldToleranceIsInMetres) {
  const TempFolder folder;
  TriMesh s = surface_of(box({1000, 1000, 1000}, 1000.0));
  s.points.push_back(s.points[7] + Vec3(0.01, 0, 0));
  Index* corner = &s.triangles[0].v[0];  // triangles are plain triples: the first corner anywhere at vertex 7
  corner = std::find(corner, corner + 3 * s.triangles.size(), 7);
  ASSERT_EQ(*corner, 7);
  *corner = 8;
  write_obj(folder.file("torn.obj"), s);
  EXPECT_THROW(surface_shape(mesh_shape(folder.file("torn.obj"), {{"scale", 1e-3}})), Error);
  EXPECT_THROW(surface_shape(mesh_shape(folder.file("torn.obj"), {{"scale", 1e-3}, {"weld", 5e-6}})), Error);
  EXPECT_EQ(surface_shape(mesh_shape(folder.file("torn.obj"), {{"scale", 1e-3}, {"weld", 2e-5}})).points.size(), 8u);
}

}  // namespace
}  // namespace mortise::geometry
