#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <vector>

#include "base/child.h"
#include "damage.h"
#include "geometry/io/visual_bytes.h"
#include "mesh_helpers.h"

namespace mortise::geometry {
namespace {

constexpr ChildLimits kLimits{20, std::size_t{1} << 30};

TEST(Child, ReturnsWhatTheJobReturns) {
  const std::string big(3'000'000, 'x');
  EXPECT_EQ(in_child("it", kLimits, [&] { return big + '\0' + "end"; }), big + '\0' + "end");
  EXPECT_EQ(in_child("it", kLimits, [] { return std::string(); }), "");
  int here = 1;
  in_child("it", kLimits, [&] { return here = 2, std::string(); });
  EXPECT_EQ(here, 1) << "it was another process";
}

TEST(Child, ErrorsArriveAsThrown) {
  expect_error([] { in_child("it", kLimits, []() -> std::string { throw Error(Exit::file, "no such thing"); }); }, Exit::file, {"no such thing"});
  expect_error([] { in_child("it", kLimits, []() -> std::string { throw std::runtime_error("odd"); }); }, Exit::scene, {"odd"});
}

TEST(Child, CrashesBecomeErrors) {
  const auto fails = [](ChildLimits limits, const std::function<void()>& job, const std::vector<std::string>& words) {
    expect_error([&] { in_child("'a.glb' cannot be read", limits, [&] { return job(), std::string(); }); }, Exit::scene, words);
  };
  fails(kLimits, [] { std::raise(SIGSEGV); }, {"'a.glb' cannot be read: its reader crashes on it (Segmentation fault)"});
  fails(kLimits, [] { std::abort(); }, {"crashes on it (Aborted)"});
  fails(kLimits, [] { _exit(0); }, {"ends without a result"});
  fails(kLimits, [] { _exit(7); }, {"ends without a result"});
  fails({1, kLimits.bytes},
        [] {
          for (volatile bool forever = true; forever;) {
          }
        },
        {"is not done after 1 s"});
}

TEST(Child, LivesInACage) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer's own calls are not let through";
#endif
  const std::string file = testing::TempDir() + "mortise_cage";
  const std::string told = in_child("it", kLimits, [&] {
    std::string out;
    out += open(file.c_str(), O_WRONLY | O_CREAT, 0600) < 0 && errno == EPERM ? "w" : "-";
    out += socket(AF_INET, SOCK_STREAM, 0) < 0 && errno == EPERM ? "n" : "-";
    out += fork() < 0 && errno == EPERM ? "f" : "-";
    out += kill(getppid(), 0) < 0 && errno == EPERM ? "k" : "-";
    out += unlink("/nowhere") < 0 && errno == EPERM ? "u" : "-";
    out += open("/proc/self/exe", O_RDONLY) >= 0 ? "r" : "-";
    return out;
  });
  EXPECT_EQ(told, "wnfkur");
}

TEST(Child, MemoryIsLimited) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer ends a process that runs out of memory";
#endif
  expect_error(
      [] {
        in_child("it", {20, std::size_t{64} << 20}, [] { return std::string(std::vector<char>(std::size_t{256} << 20, 'x').data(), 1); });
      },
      Exit::scene, {"it: its reader needs more than 64 MiB of memory"});
}

TEST(VisualBytes, AreReadBackOrRefused) {
  VisualMesh m;
  m.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0.1}}, m.normals = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}}, m.uvs = {{0, 1}, {2, 3}, {4, 5}};
  m.triangles = {{{0, 1, 2}}, {{2, 1, 0}}}, m.part = {0, 1}, m.material = {1, 0};
  m.has_uvs = true;
  m.materials = {{"red", {1, 0, 0}, 0.25, 0.75, {"wood.png", {}}}, {"", {0, 0, 1}, 1, 0, {"", {1, 2, 3}}}};
  const std::string bytes = to_bytes(m);
  const VisualMesh back = visual_from_bytes("a.glb", bytes);
  expect_same(back.points, m.points);
  expect_same(back.normals, m.normals);
  expect_same(back.triangles, m.triangles);
  EXPECT_EQ(back.uvs[2], Vec2(4, 5));
  EXPECT_EQ(back.part, m.part);
  EXPECT_EQ(back.material, m.material);
  EXPECT_TRUE(back.has_uvs);
  ASSERT_EQ(back.materials.size(), 2u);
  EXPECT_EQ(back.materials[0].texture.file, "wood.png");
  EXPECT_EQ(back.materials[1].texture.bytes, m.materials[1].texture.bytes);
  EXPECT_EQ(back.materials[0].base_color, Vec3(1, 0, 0));
  EXPECT_EQ(back.materials[0].metallic, 0.75);

  const auto read = [](const std::string& damaged) { visual_from_bytes("a.glb", damaged); };
  // All materials but the last are needed: triangle 0 has material 1.
  EXPECT_EQ(accepted_beginnings(bytes, read), 0u);
  EXPECT_GT(refused_changes(bytes, read), 400u);
}

}  // namespace
}  // namespace mortise::geometry
