#pragma once
// Runs the built program as a user would.
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "place.h"

namespace mortise::cli {

inline const std::string kSource = test_place::kSourceFolder;
inline const std::string kProgram = test_place::kBuildFolder + "/bin/mortise";

struct Result {
  int code = -1;
  std::string out, err;
};

inline std::string read_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline std::string quoted(const std::string& s) {
  std::string out = "'";
  for (char c : s) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

// `arguments` are shell words; the program runs in `folder`. `before` stands in front of the command ("NO_COLOR=1", "cat x |").
inline Result mortise(const std::string& arguments, const std::string& folder = kSource, const std::string& before = "") {
  static int count = 0;
  const std::string base = std::filesystem::temp_directory_path() / ("mortise_test_" + std::to_string(getpid()) + "_" + std::to_string(count++));
  const std::string command = "cd " + quoted(folder) + " && " + before + " " + quoted(kProgram) + " " + arguments + " >" + quoted(base + ".out") +
                              " 2>" + quoted(base + ".err");
  const int status = std::system(command.c_str());
  Result r{WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(base + ".out"), read_text(base + ".err")};
  std::filesystem::remove(base + ".out");
  std::filesystem::remove(base + ".err");
  return r;
}

}  // namespace mortise::cli
