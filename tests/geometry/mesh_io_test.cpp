#include <gtest/gtest.h>

#include <cmath>

#include "geometry/io/msh.h"
#include "geometry/io/obj.h"
#include "geometry/io/read.h"
#include "geometry/primitives.h"
#include "geometry/topology.h"
#include "geometry/topology_check.h"
#include "mesh_helpers.h"

namespace mortise::geometry {
namespace {

const std::string kFormat2 = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
const std::string kFormat4 = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
const std::string kNodes2 = "$Nodes\n5\n1 0 0 0\n2 1 0 0\n7 0 1 0\n4 0 0 1.25e-1\n5 9 9 9\n$EndNodes\n";

TEST(Msh, Version2) {
  const MshFile m = parse_msh("a.msh", kFormat2 + "$PhysicalNames\n1\n3 1 \"gel\"\n$EndPhysicalNames\n" + kNodes2 +
                                           "$Elements\n4\n1 15 2 0 1 1\n2 1 2 0 1 1 2\n3 2 2 0 1 1 2 7\n4 4 3 0 1 5 1 2 7 4\n$EndElements\n");
  ASSERT_EQ(m.points.size(), 5u);
  EXPECT_EQ(m.points[3], Vec3(0, 0, 0.125));
  expect_same(m.triangles, {{{0, 1, 2}}});
  expect_same(m.tets, {{{0, 1, 2, 3}}});
}

TEST(Msh, Version4) {
  const MshFile m =
      parse_msh("a.msh", kFormat4 +
                             "$Entities\n0 0 0 1\n1 0 0 0 1 1 1 0 0\n$EndEntities\n"
                             "$Nodes\n2 4 1 10\n0 1 0 1\n10\n1 0 0\n3 1 1 3\n1\n3\n4\n0 0 0 0.1 0.2 0.3\n0 1 0 0 0 0\n0 0 1 0 0 0\n$EndNodes\n"
                             "$Elements\n3 3 1 3\n0 1 15 1\n1 10\n2 1 2 1\n2 1 10 3\n3 1 4 1\n3 1 10 3 4\n$EndElements\n");
  expect_same(m.points, {{1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  expect_same(m.triangles, {{{1, 0, 2}}});
  expect_same(m.tets, {{{1, 0, 2, 3}}});
}

TEST(Msh, ErrorsNameFileAndLine) {
  const auto refuse = [](const std::string& text, const std::vector<std::string>& words) {
    expect_error([&] { parse_msh("dir/a.msh", text); }, Exit::scene, words);
  };
  refuse("solid\n", {"dir/a.msh:1:1: error: not a Gmsh file"});
  refuse("$MeshFormat\n4 0 8\n$EndMeshFormat\n", {"a.msh:2:", "format 4 is not supported"});
  refuse("$MeshFormat\n2.2 1 8\n$EndMeshFormat\n", {"a.msh:2:", "binary"});
  refuse(kFormat2 + "$Nodes\n1\n1 0 zero 0\n", {"a.msh:6:", "expected a coordinate, found 'zero'"});
  refuse(kFormat2 + "$Nodes\n1\n1 0 0\n", {"a.msh:6:", "line ends"});
  refuse(kFormat2 + "$Nodes\n3\n1 0 0 0\n", {"a.msh:6:", "the file ends where a node is expected"});
  refuse(kFormat2 + "$Nodes\n2\n1 0 0 0\n1 0 0 0\n", {"a.msh:7:", "node 1 is defined twice"});
  refuse(kFormat2 + "$Nodes\n1\n1 0 0 0\n2 0 0 0\n", {"a.msh:7:", "expected $EndNodes"});
  refuse(kFormat2 + kNodes2 + "$Elements\n1\n1 4 0 1 2 3 4\n", {"a.msh:14:", "node 3 is not defined"});
  refuse(kFormat2 + kNodes2 + "$Elements\n1\n1 12 0 1 2 7 4\n", {"a.msh:14:", "element type 12 is not supported"});
  refuse(kFormat2 + kNodes2, {"no $Elements"});
  refuse(kFormat2 + "$Comments\nabc\n", {"a.msh:4:", "no $EndComments"});
}

TEST(Msh, RoundTripKeepsBits) {
  const TempFolder folder;
  TetMesh m = sphere(0.1, 0.03);
  write_msh(folder.file("ball.msh"), m);
  const TetMesh back = read_tets(folder.file("ball.msh"));
  expect_same(m.points, back.points);
  expect_same(m.tets, back.tets);
  expect_same(surface_of(m).points, read_surface(folder.file("ball.msh")).points);

  // A file in the other orientation is turned, one wrong tetrahedron is left to check_tets.
  for (Tet& t : m.tets) std::swap(t.v[2], t.v[3]);
  write_msh(folder.file("turned.msh"), m);
  EXPECT_NO_THROW(check_tets(read_tets(folder.file("turned.msh")), "turned"));
  std::swap(m.tets[3].v[2], m.tets[3].v[3]);
  write_msh(folder.file("tangled.msh"), m);
  EXPECT_THROW(check_tets(read_tets(folder.file("tangled.msh")), "tangled"), Error);
}

TEST(Msh, SurfaceOfTriangles) {
  const TempFolder folder;
  const TriMesh s = surface_of(box({1, 1, 1}, 0.5));
  write_msh(folder.file("s.msh"), MshFile{s.points, s.triangles, {}});
  const TriMesh back = read_surface(folder.file("s.msh"));
  expect_same(s.points, back.points);
  expect_same(s.triangles, back.triangles);
  expect_error([&] { read_tets(folder.file("s.msh")); }, Exit::scene, {"no tetrahedra"});
}

TEST(Obj, KeepsIndicesAndDigits) {
  const std::string text =
      "# a square\nv 0 0 0\nv 1234.56789012 0 0\r\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 2\n"
      "o square\nusemtl red\nf 1/1/1 2/2/1 3/3/1 4/4/1\no other\nusemtl blue\nf -4//-1 -3//-1 -2//-1\nf 1 2 3\n";
  const ObjFile obj = parse_obj("a.obj", text, false);
  EXPECT_EQ(obj.points[1][0], 1234.56789012);
  ASSERT_EQ(obj.faces.size(), 4u);
  EXPECT_EQ(obj.faces[1].corner[2].t, 3);
  EXPECT_EQ(obj.faces[2].corner[0].v, 0);
  EXPECT_EQ(obj.faces[2].corner[0].t, -1);
  EXPECT_EQ(obj.faces[2].corner[0].n, 0);
  EXPECT_EQ(obj.faces[3].part, 1);
  EXPECT_EQ(obj.materials[obj.faces[3].material].name, "blue");

  const VisualMesh v = visual_from(obj);
  EXPECT_EQ(v.points.size(), 4u + 3 + 3) << "one render vertex per combination";
  EXPECT_EQ(v.normals[0], Vec3(0, 0, 1));
  EXPECT_NEAR(v.normals.back().norm(), 1, 1e-15);
  EXPECT_TRUE(v.has_uvs);
  EXPECT_EQ(surface_from(obj).points.size(), 4u);
}

TEST(Obj, ComputesMissingNormals) {
  const TriMesh s = surface_of(sphere(1, 0.1));
  const TempFolder folder;
  write_obj(folder.file("s.obj"), s);
  const VisualMesh v = read_visual(folder.file("s.obj"));
  ASSERT_EQ(v.points.size(), s.points.size());
  for (std::size_t i = 0; i < v.points.size(); ++i) EXPECT_GT(v.normals[i].dot(v.points[i].normalized()), 0.99);
}

TEST(Obj, RoundTripKeepsBits) {
  const TempFolder folder;
  const TriMesh s = surface_of(capsule(0.3, 0.7, 0.1));
  write_obj(folder.file("s.obj"), s);
  const TriMesh back = read_surface(folder.file("s.obj"));
  expect_same(s.points, back.points);
  expect_same(s.triangles, back.triangles);
}

TEST(Obj, Materials) {
  const TempFolder folder;
  folder.write("look.mtl", "newmtl dark wood\nKd 0.1 0.2 0.3\nNs 10\nPr 0.25\nPm 1\nmap_Kd wood grain.png\nnewmtl plain\nKd 1 0 0\n");
  const std::string path = folder.write("a.obj", "mtllib look.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl plain\nf 1 2 3\nusemtl dark wood\nf 1 3 2\n");
  const VisualMesh v = read_visual(path);
  const VisualMaterial& wood = v.materials[v.material[1]];
  EXPECT_EQ(wood.name, "dark wood");
  EXPECT_EQ(wood.base_color, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(wood.roughness, 0.25);
  EXPECT_EQ(wood.metallic, 1);
  EXPECT_EQ(wood.texture.file, folder.file("wood grain.png"));
  EXPECT_TRUE(v.materials[v.material[0]].texture.empty());

  const std::string lost = folder.write("b.obj", "mtllib lost.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  expect_error([&] { read_visual(lost); }, Exit::file, {"lost.mtl"});
  EXPECT_EQ(read_surface(lost).triangles.size(), 1u) << "simulation surfaces need no materials";
  folder.write("bad.mtl", "newmtl a\nKd 0.1 green 0\n");
  const std::string bad = folder.write("c.obj", "mtllib bad.mtl\n");
  expect_error([&] { read_visual(bad); }, Exit::scene, {"bad.mtl:2:1: error: expected a colour component, found 'green'"});
}

TEST(Obj, ErrorsNameFileAndLine) {
  const auto refuse = [](const std::string& text, const std::vector<std::string>& words) {
    expect_error([&] { parse_obj("a.obj", text, false); }, Exit::scene, words);
  };
  refuse("v 0 0\n", {"a.obj:1:1: error: line ends where a coordinate is expected"});
  refuse("\n\nv 0 0 1e\n", {"a.obj:3:", "found '1e'"});
  refuse("v 0 0 0\nf 1 2 3\n", {"a.obj:2:", "vertex 2 is not defined (1 so far)"});
  refuse("v 0 0 0\nf 0 1 1\n", {"a.obj:2:", "vertex 0"});
  refuse("v 0 0 0\nf 1/1 1/1 1/1\n", {"texture vertex 1 is not defined"});
  refuse("v 0 0 0\nf 1 1\n", {"at least three"});
  refuse("v 0 0 0\nf 1 a 1\n", {"expected vertex, found 'a'"});
}

TEST(Weld, ToleranceIsADistance) {
  TriMesh m;
  m.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 9e-4}, {0, 1, 0}, {0, 0, 1}};
  m.triangles = {{{0, 1, 2}}, {{3, 4, 5}}};
  EXPECT_EQ(weld(m, 0).points.size(), 5u);
  EXPECT_EQ(weld(m, 8e-4).points.size(), 5u);
  const TriMesh welded = weld(m, 1e-3);
  EXPECT_EQ(welded.points.size(), 4u);
  EXPECT_EQ(welded.points[1], Vec3(1, 0, 0)) << "the first one stays where it is";
  EXPECT_EQ(welded.triangles.size(), 2u);
  EXPECT_EQ(weld(m, 1.1).triangles.size(), 0u) << "collapsed triangles go";
  EXPECT_THROW(weld(m, -1), Error);
}

TEST(Weld, ExactKeepsNearbyPointsApart) {
  TriMesh m;
  m.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, std::nextafter(0.0, 1.0)}, {-0.0, 0, 0}};
  m.triangles = {{{0, 1, 2}}, {{3, 1, 2}}, {{4, 1, 2}}};
  const TriMesh w = weld(m, 0);
  EXPECT_EQ(w.points.size(), 4u);
  EXPECT_EQ(w.triangles[2].v[0], 0);
}

const std::string kDae = R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="millimeter" meter="0.001"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">1 0 0 0 20 0 0 0 300</float_array><technique_common>
<accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>
</technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><translate>5 0 0</translate><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";

TEST(Dae, UnitsAreMetresAndAxesStay) {
  const TempFolder folder;
  const TriMesh s = read_surface(folder.write("t.dae", kDae));
  ASSERT_EQ(s.points.size(), 3u);
  EXPECT_NEAR((s.points[0] - Vec3(0.006, 0, 0)).norm(), 0, 1e-9);
  EXPECT_NEAR((s.points[1] - Vec3(0.005, 0.020, 0)).norm(), 0, 1e-7);
  EXPECT_NEAR((s.points[2] - Vec3(0.005, 0, 0.300)).norm(), 0, 1e-7);
}

TEST(Dae, WhatCrashesAssimpIsAnError) {
  const TempFolder folder;
  std::string damaged = kDae;
  damaged.erase(damaged.find(" count=\"9\""), 10);  // a segmentation fault in assimp 5.2.5
  expect_error([&] { read_surface(folder.write("t.dae", damaged)); }, Exit::scene, {"t.dae' cannot be read as .dae: "});
}

// A GLB with one textured triangle, placed twice: moved, and mirrored.
std::string glb(const std::string& picture) {
  const float numbers[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, /*uv, origin top left*/ 0, 1, 1, 1, 0, 0.25};
  std::string bin(reinterpret_cast<const char*>(numbers), sizeof numbers);
  bin += picture;
  bin.resize((bin.size() + 3) / 4 * 4, '\0');
  std::string json = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"children":[1,2],"scale":[2,2,2]},{"mesh":0,"translation":[0,0,5]},{"mesh":0,"scale":[-1,1,1]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],
"materials":[{"name":"paint","pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,1],"baseColorTexture":{"index":0},"roughnessFactor":0.75,"metallicFactor":0.5}}],
"textures":[{"source":0}],"images":[{"bufferView":2,"mimeType":"image/png"}],
"buffers":[{"byteLength":)" +
                     std::to_string(bin.size()) + R"(}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24},{"buffer":0,"byteOffset":60,"byteLength":)" +
                     std::to_string(picture.size()) + R"(}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}]})";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto word = [](std::uint32_t x) { return std::string(reinterpret_cast<const char*>(&x), 4); };
  return "glTF" + word(2) + word(static_cast<std::uint32_t>(28 + json.size() + bin.size())) + word(static_cast<std::uint32_t>(json.size())) + "JSON" +
         json + word(static_cast<std::uint32_t>(bin.size())) + std::string("BIN\0", 4) + bin;
}

TEST(Glb, TransformsMaterialsAndEmbeddedTexture) {
  const TempFolder folder;
  const std::string picture = "\x89PNG not decoded here";
  const VisualMesh v = read_visual(folder.write("t.glb", glb(picture)));
  ASSERT_EQ(v.triangles.size(), 2u);
  EXPECT_EQ(v.part[0], 0);
  EXPECT_EQ(v.part[1], 1);
  const auto corner = [&](int t, int k) { return v.points[v.triangles[t].v[k]]; };
  EXPECT_EQ(corner(0, 0), Vec3(0, 0, 10));
  EXPECT_EQ(corner(0, 1), Vec3(2, 0, 10));
  // The mirrored copy keeps its front side: normal and winding agree.
  for (int t = 0; t < 2; ++t) {
    const Vec3 n = (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
    EXPECT_GT(n[2], 0);
    for (Index i : v.triangles[t].v) EXPECT_EQ(v.normals[i], Vec3(0, 0, 1));
  }
  EXPECT_TRUE(v.has_uvs);
  EXPECT_EQ(v.uvs[v.triangles[0].v[0]], Vec2(0, 0)) << "origin at the lower left";
  EXPECT_EQ(v.uvs[v.triangles[0].v[2]], Vec2(0, 0.75));
  const VisualMaterial& m = v.materials.at(v.material[0]);
  EXPECT_EQ(m.name, "paint");
  EXPECT_EQ(m.base_color, Vec3(0.5, 0.25, 1));
  EXPECT_EQ(m.roughness, 0.75);
  EXPECT_EQ(m.metallic, 0.5);
  EXPECT_EQ(std::string(m.texture.bytes.begin(), m.texture.bytes.end()), picture);
}

TEST(Glb, DamagedFilesAreRefusedOrRead) {
  const TempFolder folder;
  const std::string file = glb("\x89PNG not decoded here");
  std::size_t refused = 0, tried = 0;
  for (std::size_t n = 0; n < file.size(); n += 17, ++tried) try {
      std::string copy = file;
      if (n % 2)
        copy.resize(n);
      else
        copy[n] = '\x7f';
      read_visual(folder.write("t.glb", copy));
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), Exit::scene) << e.what();
      ++refused;
    }
  EXPECT_GT(refused, tried / 2);
}

TEST(ReadMesh, Errors) {
  const TempFolder folder;
  for (const char* name : {"none.obj", "none.msh", "none.stl", "none.glb"})
    expect_error([&] { read_surface(folder.file(name)); }, Exit::file, {"cannot read", name});
  expect_error([&] { read_surface(folder.write("a.step", "x")); }, Exit::scene, {"'.step' is not supported"});
  expect_error([&] { read_tets(folder.write("a.obj", "x")); }, Exit::scene, {"'.obj' is not supported here (.msh)"});
  expect_error([&] { read_visual(folder.write("a.glb", "rubbish")); }, Exit::scene, {"a.glb", "cannot be read as .glb"});
  expect_error([&] { read_surface(folder.write("b.obj", "v 0 0 0\n")); }, Exit::scene, {"no triangles"});
}

std::string shared(const std::string& name) { return std::string(MORTISE_SHARED_DATA) + "/" + name; }

TEST(RealMeshes, UmiGripper) {
  const std::string holder = shared("robots/umi_gripper/left_finger_holder.stl"), finger = shared("robots/umi_gripper/left_finger.stl");
  if (!std::filesystem::exists(holder)) GTEST_SKIP() << "no shared data";
  const TriMesh s = read_surface(holder);
  EXPECT_NO_THROW(check_closed_surface(s, "holder"));
  EXPECT_NEAR(mass_properties(s).volume, 3.30e-5, 1e-7);
  // Vertices of this file differ in their last digits.
  expect_error([&] { check_closed_surface(read_surface(finger), "finger"); }, Exit::scene, {"open", "weld"});
  EXPECT_NO_THROW(check_closed_surface(read_surface(finger, 1e-6), "finger"));
}

TEST(RealMeshes, Go2) {
  const std::string calf = shared("robots/go2/calf.dae"), foot = shared("robots/go2/foot.dae");
  if (!std::filesystem::exists(calf)) GTEST_SKIP() << "no shared data";
  const VisualMesh v = read_visual(calf);
  EXPECT_EQ(v.materials.size(), 2u);
  Vec3 lo = v.points[0], hi = lo;
  for (const Vec3& p : v.points) lo = lo.cwiseMin(p), hi = hi.cwiseMax(p);
  EXPECT_LT(lo[2], -0.2) << "the shank hangs along -z: axes as in the file";
  EXPECT_LT(hi[2], 0.05);
  EXPECT_NO_THROW(check_closed_surface(read_surface(foot, 5e-5), "foot"));
}

}  // namespace
}  // namespace mortise::geometry
