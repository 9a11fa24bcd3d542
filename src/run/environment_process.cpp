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
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/process.h"

namespace mortise::run {
namespace {

using Json = nlohmann::ordered_json;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

constexpr long kNobody = -1;  // speaks of the process itself

void say(long environment, const Json& event) {
  std::fputs((std::to_string(environment) + " " + json_text(event) + "\n").c_str(), stdout);
  std::fflush(stdout);
}

// The exit code of what was no environment's own.
int run_here(const std::function<void()>& work) {
  const auto failed = [](Exit code, const std::string& message) {
    say(kNobody, Json{{"event", "error"}, {"message", message}});
    return static_cast<int>(code);
  };
  try {
    work();
    return 0;
  } catch (const Error& e) {
    return failed(e.code(), e.what());
  } catch (const std::bad_alloc&) {
    return failed(Exit::device, "out of memory");
  } catch (const std::exception& e) {
    return failed(Exit::internal, e.what());
  }
}

}  // namespace

EnvironmentProcess::EnvironmentProcess(std::vector<long> environments, int threads, const std::function<void()>& work)
    : environments_(std::move(environments)), threads_(threads), began_(now()) {
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

bool EnvironmentProcess::listen(const std::function<void(long, const std::string&)>& said, const std::function<void(long)>& ended,
                                std::vector<EnvironmentEnd>& all) {
  char bytes[16384];
  const ssize_t n = ::read(pipe_, bytes, sizeof bytes);
  if (n < 0 && errno == EINTR) return true;
  if (n <= 0) {
    end(ended, all);
    return false;
  }
  line_.append(bytes, static_cast<std::size_t>(n));
  std::size_t from = 0;
  for (std::size_t at; (at = line_.find('\n', from)) != std::string::npos; from = at + 1) {
    const std::size_t space = line_.find(' ', from);
    const long e = std::strtol(line_.c_str() + from, nullptr, 10);
    const std::string line = line_.substr(space + 1, at - space - 1);
    const auto is = [&](const char* event) { return line.rfind(std::string("{\"event\":\"") + event + "\"", 0) == 0; };
    if (e == kNobody) {
      const Json event = Json::parse(line, nullptr, false);
      if (event.is_object()) error_ = event.value("message", "");
    } else if (is("ended")) {
      const Json event = Json::parse(line, nullptr, false);
      EnvironmentEnd& of = all[e];
      of.code = event.value("code", 1), of.message = event.value("message", "");
      of.wall = event.value("wall", 0.0), of.cpu = event.value("cpu", 0.0);
      told_.insert(e);
      if (environments_.size() > 1) ended(e);
    } else {
      said(e, line);
    }
  }
  line_.erase(0, from);
  return true;
}

// What the system knows of the process; of a single environment that is what it took.
void EnvironmentProcess::end(const std::function<void(long)>& ended, std::vector<EnvironmentEnd>& all) {
  int how = 0;
  rusage used = {};
  while (wait4(process_, &how, 0, &used) < 0 && errno == EINTR) {
  }
  process_ = -1;
  const bool single = environments_.size() == 1;
  for (long e : environments_) {
    EnvironmentEnd& of = all[e];
    of.memory = 1024LL * used.ru_maxrss;
    if (single) of.wall = now() - began_, of.cpu = cpu_seconds(used);
    if (!told_.count(e)) {
      of.wall = now() - began_;
      of.message = error_;
      of.code = WIFEXITED(how) && WEXITSTATUS(how) != 0 ? WEXITSTATUS(how) : static_cast<int>(Exit::internal);
      if (WIFSIGNALED(how))
        of.message = fmt::format("its process was ended by signal {} ({}){}", WTERMSIG(how), strsignal(WTERMSIG(how)),
                                 WTERMSIG(how) == SIGKILL ? ", as the system does where memory is short" : "");
    }
    if (single || !told_.count(e)) ended(e);
  }
}

void tell_end(long environment, const EnvironmentEnd& end) {
  say(environment, Json{{"event", "ended"}, {"code", end.code}, {"message", end.message}, {"wall", end.wall}, {"cpu", end.cpu}});
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
