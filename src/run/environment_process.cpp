#include "run/environment_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/process.h"

namespace mortise::run {
namespace {

using Json = nlohmann::ordered_json;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// The exit code; what went wrong is the last line on the standard output.
int run_here(const std::function<Exit(Progress&)>& work) {
  const auto failed = [](Exit code, const std::string& message) {
    std::fputs((Json{{"event", "error"}, {"message", message}}.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n").c_str(), stdout);
    return static_cast<int>(code);
  };
  const std::unique_ptr<Progress> progress = make_progress(true, false);
  try {
    return static_cast<int>(work(*progress));
  } catch (const Error& e) {
    return failed(e.code(), e.what());
  } catch (const std::bad_alloc&) {
    return failed(Exit::device, "out of memory");
  } catch (const std::exception& e) {
    return failed(Exit::internal, e.what());
  }
}

}  // namespace

EnvironmentProcess::EnvironmentProcess(long environment, int threads, const std::function<Exit(Progress&)>& work)
    : environment_(environment), threads_(threads), began_(now()) {
  int ends[2];
  std::fflush(nullptr);  // or both would print what waits
  if (pipe2(ends, O_CLOEXEC) != 0) throw Error(Exit::internal, std::string("cannot make a pipe: ") + std::strerror(errno));
  const pid_t parent = getpid();
  process_ = fork();
  if (process_ < 0) {
    close(ends[0]), close(ends[1]);
    throw Error(Exit::internal, "cannot start a process");
  }
  if (process_ == 0) {
    setpgid(0, 0);                        // what a terminal sends reaches it through its parent, once
    prctl(PR_SET_PDEATHSIG, SIGKILL);     // an environment stands that; one that nobody waits for would hold its folder
    if (getppid() != parent) _exit(127);  // it was too late for that
    dup2(ends[1], STDOUT_FILENO);
    if (const int none = open("/dev/null", O_RDONLY); none >= 0) dup2(none, STDIN_FILENO);
    const int code = run_here(work);
    std::fflush(nullptr);
    _exit(code);
  }
  close(ends[1]);
  pipe_ = ends[0];
}

EnvironmentProcess::~EnvironmentProcess() {
  if (pipe_ >= 0) close(pipe_);
  if (process_ < 0) return;
  ::kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

void EnvironmentProcess::signal(int number) const {
  if (process_ > 0) ::kill(process_, number);
}

bool EnvironmentProcess::listen(const std::function<void(const std::string&)>& said, EnvironmentEnd& end) {
  char bytes[16384];
  const ssize_t n = ::read(pipe_, bytes, sizeof bytes);
  if (n < 0 && errno == EINTR) return true;
  if (n <= 0) {
    ended(end);
    return false;
  }
  line_.append(bytes, static_cast<std::size_t>(n));
  for (std::size_t at; (at = line_.find('\n')) != std::string::npos; line_.erase(0, at + 1)) {
    const std::string line = line_.substr(0, at);
    const Json event = line.rfind("{\"event\":\"error\"", 0) == 0 ? Json::parse(line, nullptr, false) : Json();
    if (event.is_object())
      error_ = event.value("message", "");
    else
      said(line);
  }
  return true;
}

void EnvironmentProcess::ended(EnvironmentEnd& end) {
  int how = 0;
  rusage used = {};
  while (wait4(process_, &how, 0, &used) < 0 && errno == EINTR) {
  }
  process_ = -1;
  end.wall = now() - began_;
  end.cpu = cpu_seconds(used);
  end.memory = 1024LL * used.ru_maxrss;
  end.message = error_;
  end.code = WIFEXITED(how) ? WEXITSTATUS(how) : static_cast<int>(Exit::internal);
  if (WIFSIGNALED(how))
    end.message = fmt::format("its process was ended by signal {} ({}){}", WTERMSIG(how), strsignal(WTERMSIG(how)),
                              WTERMSIG(how) == SIGKILL ? ", as the system does where memory is short" : "");
}

int asked_aside(const std::function<int()>& work) {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0) throw Error(Exit::internal, "cannot start a process");
  if (child == 0) {
    int code = static_cast<int>(Exit::internal);
    try {
      code = work();
    } catch (const Error& e) {
      code = static_cast<int>(e.code());
    } catch (...) {
    }
    _exit(code);
  }
  int how = 0;
  while (waitpid(child, &how, 0) < 0 && errno == EINTR) {
  }
  return code_of(how);
}

}  // namespace mortise::run
