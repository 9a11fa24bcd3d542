#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "damage.h"
#include "geometry/io/assimp.h"
#include "geometry/io/ply.h"
#include "geometry/io/read.h"
#include "geometry/primitives.h"
#include "geometry/topology.h"
#include "mesh_helpers.h"

namespace mortise::geometry {
namespace {

enum class Form { ascii, little, big };
constexpr Form kForms[] = {Form::ascii, Form::little, Form::big};
const char* name_of(Form f) { return f == Form::ascii ? "ascii" : f == Form::little ? "binary_little_endian" : "binary_big_endian"; }

// Values as the body of a PLY file has them.
struct Body {
  Form form;
  std::string text;
  template <class T>
  void put(T value) {
    if (form == Form::ascii) {
      char word[32];
      std::snprintf(word, sizeof word, "%.17g ", static_cast<double>(value));
      text += word;
      return;
    }
    std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
    if ((form == Form::big) != (std::endian::native == std::endian::big)) std::reverse(bytes.begin(), bytes.end());
    text += bytes;
  }
  void end_line() {
    if (form == Form::ascii) text += "\n";
  }
};

// Every kind of type, properties nobody asked for, elements before, between and behind; faces are a triangle and a quadrangle.
std::string everything(Form form) {
  Body b{form, std::string("ply\r\nformat ") + name_of(form) +
                   " 1.0\r\ncomment made by hand\nobj_info none\n"
                   "element camera 1\nproperty list uint8 int16 numbers\nproperty char sign\n"
                   "element vertex 5\nproperty double x\nproperty uchar red\nproperty float32 z\nproperty float y\nproperty list ushort uint rings\n"
                   "property float nx\nproperty float ny\nproperty float nz\nproperty float u\nproperty float v\n"
                   "element edge 1\nproperty int vertex1\nproperty int32 vertex2\n"
                   "element face 2\nproperty int8 flags\nproperty list uint8 int vertex_indices\nproperty list uchar float texcoord\nend_header\n"};
  b.put(std::uint8_t{2}), b.put(std::int16_t{-7}), b.put(std::int16_t{300}), b.put(std::int8_t{-1}), b.end_line();
  const Vec3 p[] = {{0.1, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {-0.25, 2.5, 1e3}};
  for (int i = 0; i < 5; ++i) {
    b.put(p[i][0]), b.put(std::uint8_t(250)), b.put(float(p[i][2])), b.put(float(p[i][1]));
    b.put(std::uint16_t(i));
    for (int k = 0; k < i; ++k) b.put(std::uint32_t{4000000000u});
    b.put(0.0f), b.put(0.0f), b.put(2.0f), b.put(0.5f * i), b.put(0.25f), b.end_line();
  }
  b.put(std::int32_t{0}), b.put(std::int32_t{4}), b.end_line();
  b.put(std::int8_t{1}), b.put(std::uint8_t{3});
  for (int v : {0, 1, 4}) b.put(std::int32_t{v});
  b.put(std::uint8_t{0}), b.end_line();
  b.put(std::int8_t{-128}), b.put(std::uint8_t{4});
  for (int v : {3, 2, 1, 0}) b.put(std::int32_t{v});
  b.put(std::uint8_t{1}), b.put(0.5f), b.end_line();
  return b.text;
}

std::string plain(Form form, const TriMesh& m) {
  Body b{form, std::string("ply\nformat ") + name_of(form) + " 1.0\nelement vertex " + std::to_string(m.points.size()) +
                   "\nproperty double x\nproperty double y\nproperty double z\nelement face " + std::to_string(m.triangles.size()) +
                   "\nproperty list uchar uint vertex_index\nend_header\n"};
  for (const Vec3& p : m.points) b.put(p[0]), b.put(p[1]), b.put(p[2]), b.end_line();
  for (const Triangle& t : m.triangles) b.put(std::uint8_t{3}), b.put(t.v[0]), b.put(t.v[1]), b.put(t.v[2]), b.end_line();
  return b.text;
}

TEST(Ply, AllTypesInAllForms) {
  for (Form form : kForms) {
    const PlyFile f = parse_ply("a.ply", everything(form));
    expect_same(f.points, {{0.1, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {-0.25, 2.5, 1e3}});
    expect_same(f.triangles, {{{0, 1, 4}}, {{3, 2, 1}}, {{3, 1, 0}}});
    ASSERT_EQ(f.normals.size(), 5u);
    EXPECT_EQ(f.normals[4], Vec3(0, 0, 2));
    ASSERT_EQ(f.uvs.size(), 5u);
    EXPECT_EQ(f.uvs[3], Vec2(1.5, 0.25));
    const VisualMesh v = visual_from("a.ply", f);
    EXPECT_TRUE(v.has_uvs);
    EXPECT_EQ(v.normals[0], Vec3(0, 0, 1));
    EXPECT_EQ(v.points.size(), 5u);
  }
}

TEST(Ply, RoundTripKeepsBits) {
  const TempFolder folder;
  const TriMesh s = surface_of(capsule(0.3, 0.7, 0.1));
  for (Form form : kForms) {
    const TriMesh back = read_surface(folder.write("s.ply", plain(form, s)));
    expect_same(back.points, s.points);
    expect_same(back.triangles, s.triangles);
    const VisualMesh v = read_visual(folder.file("s.ply"));
    ASSERT_EQ(v.points.size(), s.points.size());
    EXPECT_FALSE(v.has_uvs);
    for (std::size_t i = 0; i < v.points.size(); ++i) EXPECT_GT(v.normals[i].norm(), 0.99);
  }
}

TEST(Ply, ReadsAsAssimpDoes) {
  const TempFolder folder;
  TriMesh s = surface_of(sphere(1, 0.2));
  for (Vec3& p : s.points) p = (1024 * p).array().round() / 1024;  // fits into the floats of assimp
  for (Form form : kForms) {
    const std::string path = folder.write("s.ply", plain(form, s));
    const VisualMesh theirs = read_with_assimp(path), ours = read_visual(path);
    expect_same(ours.points, theirs.points);
    expect_same(ours.triangles, theirs.triangles);
  }
}

TEST(Ply, ErrorsNameFileAndPlace) {
  const auto refuse = [](const std::string& text, const std::vector<std::string>& words) {
    expect_error([&] { parse_ply("dir/a.ply", text); }, Exit::scene, words);
  };
  const std::string begin = "ply\nformat ascii 1.0\n", vertex = "property float x\nproperty float y\nproperty float z\n",
                    face = "element face 1\nproperty list uchar int vertex_indices\n";
  const auto file = [&](const std::string& body) { return begin + "element vertex 3\n" + vertex + face + "end_header\n" + body; };
  refuse("", {"dir/a.ply", "not a PLY file"});
  refuse("solid", {"dir/a.ply:1:1: error: not a PLY file"});
  refuse("ply\nformat ascii 2.0\n", {"a.ply:2:", "version 2.0 is not supported"});
  refuse("ply\nformat utf8 1.0\n", {"a.ply:2:", "expected a format (ascii,", "found 'utf8'"});
  refuse("ply\nelement vertex 1\n" + vertex + "end_header\n0 0 0\n", {"does not name the format"});
  refuse(begin + "property float x\n", {"a.ply:3:", "a property before the first element"});
  refuse(begin + "element vertex 1\nproperty quad x\n", {"a.ply:4:", "expected a type (char,", "found 'quad'"});
  refuse(begin + "element vertex 1\nproperty float x\nproperty float x\n", {"a.ply:5:", "property 'x' is described twice"});
  refuse(begin + "element vertex 1\nelement vertex 1\n", {"a.ply:4:", "element 'vertex' is described twice"});
  refuse(begin + "element vertex -1\n", {"a.ply:3:", "out of range: -1"});
  refuse(begin + "element vertex 3000000000\n", {"a.ply:3:", "out of range"});
  refuse(begin + "element vertex 1\nend_header\n", {"a.ply:3:", "element 'vertex' has no properties"});
  refuse(begin + "element vertex 1\nproperty float x\nend_header\n0\n", {"element 'vertex' has no properties x, y and z"});
  refuse(begin + face + "end_header\n3 0 1 2\n", {"describes no element 'vertex'"});
  refuse(begin + "element vertex 1\n" + vertex, {"the file ends where 'end_header' is expected"});
  refuse(begin + "vertices 4\n", {"a.ply:3:", "found 'vertices'"});
  refuse(file("0 0 0\n1 0 0\n"), {"a.ply:11:", "the file ends where an element 'vertex' is expected"});
  refuse(file("0 0 0\n1 0 zero\n"), {"a.ply:11:", "expected a number, found 'zero'"});
  refuse(file("0 0 0\n1 0 inf\n"), {"a.ply:11:", "a coordinate of vertex 1 is not a finite number"});
  refuse(file("0 0 0\n1 0 0 0\n"), {"a.ply:11:", "expected the end of the line, found '0'"});
  refuse(file("0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), {"a.ply:13:", "face 0 names a vertex that is not there (the file has 3)"});
  refuse(file("0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), {"not there"});
  refuse(file("0 0 0\n1 0 0\n0 1 0\n3 0 1 1.5\n"), {"not there"});
  refuse(file("0 0 0\n1 0 0\n0 1 0\n2 0 1\n"), {"face 0 has less than three vertices"});
  refuse(file("0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n"), {"a.ply:13:", "line ends where a number is expected"});
  refuse(file("0 0 0\n1 0 0\n0 1 0\n-1 0 1 2\n"), {"the length of a list is out of range"});
  refuse(file("0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n"), {"a.ply:14:", "expected the end of the file"});

  TriMesh s = surface_of(box({1, 1, 1}, 1));
  std::string many = plain(Form::little, s);
  many.replace(many.find("vertex 8"), 8, "vertex 2000000000");
  refuse(many, {"dir/a.ply', byte", "the header counts 2000000000 of element 'vertex', each of 24 bytes or more; the file has"});
  refuse(plain(Form::big, s) + "x", {"found 1 bytes more"});
  s.points[3][1] = std::nan("");
  for (Form form : kForms) refuse(plain(form, s), {"a coordinate of vertex 3 is not a finite number"});
}

TEST(Ply, DamagedFilesAreRefusedOrRead) {
  const auto read = [](const std::string& bytes) {
    const PlyFile f = parse_ply("a.ply", bytes);
    visual_from("a.ply", f);
    for (const Triangle& t : f.triangles)
      for (Index v : t.v) ASSERT_TRUE(v >= 0 && static_cast<std::size_t>(v) < f.points.size());
  };
  for (Form form : kForms) {
    const std::string file = everything(form);
    // The last byte of the ASCII file ends a line, the one before is the blank behind the last number, which may lose "0.5"'s last digits.
    EXPECT_LE(accepted_beginnings(file, read), form == Form::ascii ? 4u : 0u) << name_of(form);
    EXPECT_GT(refused_changes(file, read), 1000u) << name_of(form);
  }
}

}  // namespace
}  // namespace mortise::geometry
