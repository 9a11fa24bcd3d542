#pragma once
// The built program as a process of its own, for tests that disturb it.
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "output/checkpoint.h"
#include "program.h"

namespace mortise::cli {

// Starts the program without waiting for it. `in_child` runs in the new process before the program does.
inline pid_t start(std::vector<std::string> args, const std::function<void()>& in_child = {}) {
  const pid_t pid = fork();
  if (pid != 0) return pid;
  if (in_child) in_child();
  std::vector<char*> argv{const_cast<char*>(kProgram.c_str())};
  for (std::string& a : args) argv.push_back(a.data());
  argv.push_back(nullptr);
  execv(argv[0], argv.data());
  _exit(127);
}

inline int wait_for(pid_t pid) {
  int status = 0;
  waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// All arrays of the newest checkpoint in an output folder, bit for bit (NaN is equal to itself then).
inline std::map<std::string, std::string> last_state(const std::string& dir) {
  std::map<std::string, std::string> out;
  const output::CheckpointReader reader(dir + "/checkpoint.h5");
  for (const auto& [name, values] : reader.arrays()) out[name].assign(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
  return out;
}

// The arrays of these states that are not equal.
inline std::string unlike(const std::string& dir, const std::string& other) {
  std::map<std::string, std::string> a = last_state(dir), b = last_state(other);
  std::string out;
  for (const auto& [name, values] : a)
    if (const auto it = b.find(name); it == b.end() || it->second != values) out += name + (it == b.end() ? " (only the first) " : " ");
  for (const auto& [name, values] : b)
    if (!a.count(name)) out += name + " (only the second) ";
  return out;
}

}  // namespace mortise::cli
