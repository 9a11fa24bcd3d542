#include <gtest/gtest.h>

#include <cmath>

#include "damage.h"
#include "geometry/io/assimp.h"
#include "geometry/io/read.h"
#include "geometry/io/stl.h"
#include "geometry/primitives.h"
#include "geometry/topology.h"
#include "geometry/topology_check.h"
#include "mesh_helpers.h"

namespace mortise::geometry {
namespace {

TriMesh sample() { return surface_of(box({1, 2, 3}, 0.5)); }

std::string ascii(const TriMesh& s, const std::string& normal = "0 0 0") {
  std::string out = "solid two words\n";
  for (const Triangle& t : s.triangles) {
    out += "  facet normal " + normal + "\n    outer loop\n";
    for (Index v : t.v) {
      char line[96];
      std::snprintf(line, sizeof line, "      vertex %.9g %.9g %.9e\n", s.points[v][0], s.points[v][1], s.points[v][2]);
      out += line;
    }
    out += "    endloop\n  endfacet\n";
  }
  return out + "endsolid two words\n";
}

std::string binary(const TriMesh& s, const std::string& title = "", const Vec3& normal = Vec3::Zero()) {
  std::string out = title;
  out.resize(80, ' ');
  const auto put = [&](const auto& value) { out.append(reinterpret_cast<const char*>(&value), sizeof value); };
  const auto vec3 = [&](const Vec3& v) {
    for (int k = 0; k < 3; ++k) put(static_cast<float>(v[k]));
  };
  put(static_cast<std::uint32_t>(s.triangles.size()));
  for (const Triangle& t : s.triangles) {
    vec3(normal);
    for (Index v : t.v) vec3(s.points[v]);
    put(std::uint16_t{0x1234});
  }
  return out;
}

TEST(Stl, BinaryAndAsciiGiveTheSurfaceThatWasWritten) {
  const TempFolder folder;
  const TriMesh s = sample();
  const TriMesh a = read_surface(folder.write("a.stl", ascii(s))), b = read_surface(folder.write("b.STL", binary(s)));
  expect_same(a.points, b.points);
  expect_same(a.triangles, b.triangles);
  ASSERT_EQ(a.points.size(), s.points.size());
  ASSERT_EQ(a.triangles.size(), s.triangles.size());
  for (std::size_t i = 0; i < s.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) EXPECT_EQ(a.points[a.triangles[i].v[k]], s.points[s.triangles[i].v[k]]);
}

TEST(Stl, AsciiKeepsAllDigits) {
  const StlFile f = parse_stl(
      "a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0.123456789012345 0 0\nvertex 1 0 0\nvertex +1 1e-3 0\nendloop\nendfacet\nendsolid");
  EXPECT_EQ(f.facets.at(0).corner[0][0], 0.123456789012345);
  EXPECT_EQ(f.facets[0].corner[2], Vec3(1, 1e-3, 0));
}

TEST(Stl, ABinaryFileMayBeginWithSolid) {
  EXPECT_EQ(parse_stl("a.stl", binary(sample(), "solid exported")).facets.size(), sample().triangles.size());
  std::string cut = binary(sample(), "solid exported");
  cut.resize(300);
  expect_error([&] { parse_stl("a.stl", cut); }, Exit::scene, {"'a.stl', byte 84", "triangles, which makes a file of", "this one has 300"});
}

TEST(Stl, VisualHasNormalsOfTheFileOrOfTheTriangles) {
  const TempFolder folder;
  TriMesh one;
  one.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, one.triangles = {{{0, 1, 2}}};
  const Vec3 tilted = Vec3(0, 3, 4);
  for (const Vec3& n : read_visual(folder.write("a.stl", binary(one, "", tilted))).normals) EXPECT_LT((n - tilted / 5).norm(), 1e-7);
  for (const Vec3& n : read_visual(folder.write("a.stl", ascii(one, "nan nan nan"))).normals) EXPECT_EQ(n, Vec3(0, 0, 1));
  for (const Vec3& n : read_visual(folder.write("a.stl", ascii(one, "-1.#IND 0 0"))).normals) EXPECT_EQ(n, Vec3(0, 0, 1));
  for (const Vec3& n : read_visual(folder.write("a.stl", ascii(one, "inf 0 0"))).normals) EXPECT_EQ(n, Vec3(0, 0, 1));

  const VisualMesh two = read_visual(folder.write("b.stl", ascii(one) + ascii(one)));
  EXPECT_EQ(two.part, (std::vector<Index>{0, 1}));
  EXPECT_EQ(two.points.size(), 6u) << "parts share no vertices";
  EXPECT_EQ(two.materials.size(), 1u);
  EXPECT_FALSE(two.has_uvs);
}

TEST(Stl, ErrorsNameFileAndPlace) {
  const auto refuse = [](const std::string& text, const std::vector<std::string>& words) {
    expect_error([&] { parse_stl("dir/a.stl", text); }, Exit::scene, words);
  };
  const std::string facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
  refuse("", {"'dir/a.stl', byte 0: not an STL file"});
  refuse("rubbish", {"neither begins with 'solid' nor"});
  refuse("solid a\n" + facet, {"dir/a.stl:1:1: error: this solid has no 'endsolid'"});
  refuse("solid a\nsolid b\n", {"dir/a.stl:2:1: error: expected 'facet' or 'endsolid', found 'solid'"});
  refuse("solid a\nendsolid\n" + facet, {"dir/a.stl:3:1: error: expected 'solid', found 'facet'"});
  refuse("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 zero 0\n", {"a.stl:4:", "expected a coordinate, found 'zero'"});
  refuse("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 nan 0\n", {"a.stl:4:", "a coordinate is not a finite number: 'nan'"});
  refuse("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0 0 0\nendloop\n", {"a.stl:6:", "expected 'vertex', found 'endloop'"});
  refuse("solid a\nfacet normal 0 0 1\nouter loop\n", {"the file ends where 'vertex' is expected"});
  refuse("solid a\nfacet normal 0 0\n", {"a.stl:2:", "line ends where a normal component is expected"});

  TriMesh bad = sample();
  bad.points[bad.triangles[3].v[1]][2] = std::nan("");
  refuse(binary(bad), {"a.stl', byte", "is not a finite number"});
  std::string many = binary(sample());
  many[83] = '\x7f';
  refuse(many, {"the header counts 213", "this one has"});
  refuse(binary(sample()) + "x", {"this one has"});
}

TEST(Stl, DamagedFilesAreRefusedOrRead) {
  TriMesh s;
  s.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  s.triangles = {{{0, 2, 1}}, {{0, 1, 3}}, {{0, 3, 2}}, {{1, 2, 3}}};
  const auto read = [](const std::string& bytes) { visual_from("a.stl", parse_stl("a.stl", bytes)); };
  EXPECT_EQ(accepted_beginnings(binary(s), read), 0u);
  EXPECT_EQ(accepted_beginnings(ascii(s), read), std::string(" two words\n").size()) << "all but the name behind 'endsolid' is needed";
  EXPECT_GT(refused_changes(binary(s), read), 30u);
  EXPECT_GT(refused_changes(ascii(s), read), 1000u);
}

TEST(Stl, RealFilesReadAsAssimpReadsThem) {
  const std::string folder = std::string(MORTISE_SHARED_DATA) + "/robots/umi_gripper/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data";
  for (const char* name : {"base_link", "left_finger", "left_finger_holder", "right_finger", "right_finger_holder"}) {
    const std::string path = folder + name + ".stl";
    const VisualMesh theirs = read_with_assimp(path), ours = read_visual(path);
    const TriMesh surface = read_surface(path), expected = weld(TriMesh{theirs.points, theirs.triangles}, 0);
    expect_same(surface.points, expected.points);
    expect_same(surface.triangles, expected.triangles);
    expect_same(ours.points, theirs.points);
    expect_same(ours.normals, theirs.normals);
    expect_same(ours.triangles, theirs.triangles);
  }
}

}  // namespace
}  // namespace mortise::geometry
