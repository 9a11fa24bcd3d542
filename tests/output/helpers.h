#pragma once
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/error.h"
#include "output/field_file.h"
#include "output/mesh.h"

namespace mortise::output {

// An empty folder that goes away with the test.
class Folder {
 public:
  Folder() {
    path_ = (std::filesystem::temp_directory_path() / "mortise-output-XXXXXX").string();
    ::mkdtemp(path_.data());
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// Two bodies: one tetrahedron (points 0-3) and two triangles (points 4-7).
inline OutputMesh small_mesh() {
  OutputMesh m;
  for (int i = 0; i < 8; ++i) m.points.emplace_back(0.1 * i, 0.01 * i * i, 1.0 / (i + 1));
  m.connectivity = {0, 1, 2, 3, 4, 5, 6, 4, 6, 7};
  m.offsets = {0, 4, 7, 10};
  m.types = {tetrahedron, triangle, triangle};
  m.body_of_cell = {0, 1, 1};
  m.body_of_point = {0, 0, 0, 0, 1, 1, 1, 1};
  m.body_names = {"pad", "tool"};
  return m;
}

inline FileInfo small_info() { return {"0.1.0", "0123abc", "mortise: 1\nname: \"\xC3\xBC\"\n", std::string(64, 'a')}; }

inline std::vector<double> flat(const OutputMesh& mesh, double shift) {
  std::vector<double> out;
  for (const Vec3& x : mesh.points) out.insert(out.end(), {x[0] + shift, x[1], x[2] - shift});
  return out;
}

// Values that tell field, frame and entry apart.
inline std::vector<double> ramp(std::size_t n, double base) {
  std::vector<double> out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = base + 0.37 * static_cast<double>(i);
  return out;
}

inline void expect_f32(const std::vector<double>& got, const std::vector<double>& want) {
  ASSERT_EQ(got.size(), want.size());
  for (std::size_t i = 0; i < got.size(); ++i) EXPECT_EQ(got[i], static_cast<double>(static_cast<float>(want[i]))) << i;
}

// Message of the Error(Exit::file) that `f` throws; fails the test if there is none.
inline std::string file_error(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::file) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return "";
}

// Runs `f` in a child process; gives its wait status. `f` returns the exit code.
inline int in_child(const std::function<int()>& f) {
  const pid_t child = ::fork();
  if (child == 0) {
    int code = 99;
    try {
      code = f();
    } catch (...) {
    }
    ::_exit(code);
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  return status;
}

}  // namespace mortise::output
