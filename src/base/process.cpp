#include "base/process.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>

#include "base/error.h"

namespace mortise {

std::string own_program() { return std::filesystem::read_symlink("/proc/self/exe").string(); }

pid_t start_program(const std::vector<std::string>& arguments, const std::string& out, const std::string& err,
                    const std::function<void()>& in_child) {
  std::vector<char*> argv;
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child < 0) throw Error(Exit::internal, "cannot start a process");
  if (child > 0) return child;
  if (in_child) in_child();
  const auto to = [](int fd, int target) {
    if (fd >= 0) dup2(fd, target);
  };
  to(open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644), STDOUT_FILENO);
  to(err == out ? STDOUT_FILENO : open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644), STDERR_FILENO);
  execv(argv[0], argv.data());
  _exit(127);
}

int code_of(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

double cpu_seconds(const rusage& used) {
  const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

}  // namespace mortise
