#include "bridge/partner.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstring>
#include <thread>

#include "base/error.h"
#include "bridge/exit.h"
#include "bridge/tuning.h"

extern char** environ;

namespace mortise::bridge {
namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

Partner::Partner(std::string command, double timeout) : command_(std::move(command)), timeout_(timeout) {
  std::signal(SIGPIPE, SIG_IGN);  // a partner that hears no more shows as a write that fails
  if (command_ == "-") {
    input_ = STDIN_FILENO, output_ = STDOUT_FILENO;
    return;
  }
  int to[2], from[2];
  if (pipe2(to, O_CLOEXEC) != 0) throw Error(Exit::internal, std::string("cannot make a pipe: ") + std::strerror(errno));
  if (pipe2(from, O_CLOEXEC) != 0) {
    close(to[0]), close(to[1]);
    throw Error(Exit::internal, std::string("cannot make a pipe: ") + std::strerror(errno));
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, to[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, from[1], STDOUT_FILENO);
  // A group of its own: what a terminal sends reaches this program alone, and with the shell its children can be ended.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t usual, none;
  sigemptyset(&none), sigemptyset(&usual);
  for (int s : {SIGPIPE, SIGINT, SIGTERM, SIGUSR1, SIGXFSZ}) sigaddset(&usual, s);
  posix_spawnattr_setsigdefault(&attributes, &usual);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  std::string shell = "sh", c = "-c";
  char* argv[] = {shell.data(), c.data(), command_.data(), nullptr};
  const int failed = posix_spawn(&child_, "/bin/sh", &actions, &attributes, argv, environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  close(to[0]), close(from[1]);
  output_ = to[1], input_ = from[0];
  if (failed) {
    child_ = -1;
    close(input_), close(output_);
    throw Error(Exit::internal, std::string("cannot start the bridge's partner: ") + std::strerror(failed));
  }
}

Partner::~Partner() {
  const double until = now() + kFarewell;
  while (!out_.empty() && output_ >= 0 && now() < until) {
    pollfd p{output_, POLLOUT, 0};
    if (poll(&p, 1, kSlice) > 0) write_some();
  }
  if (child_ < 0) return;
  close(output_);
  // Until it has seen the end, it may still want to say something.
  while (!heard_all_ && now() < until) {
    pollfd p{input_, POLLIN, 0};
    if (poll(&p, 1, kSlice) > 0) read_some(), in_.clear();
  }
  close(input_);
  if (ended(std::max(until - now(), 0.0)) < 0) {
    kill(-child_, SIGTERM);
    if (ended(kFarewell / 2) < 0) kill(-child_, SIGKILL), ended(kFarewell);
  }
}

int Partner::ended(double seconds) {
  if (child_ < 0) return -1;
  int status = 0;
  for (const double until = now() + seconds;;) {
    const pid_t got = waitpid(child_, &status, WNOHANG);
    if (got == child_) {
      kill(-child_, SIGTERM);  // what its shell left behind
      child_ = -1;
      return status;
    }
    if (now() >= until) return -1;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

void Partner::gone(const std::string& to) {
  const std::string name = who();
  const int status = ended(kFarewell / 2);
  std::string how;
  if (status >= 0)
    how = WIFSIGNALED(status) ? fmt::format(" by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)))
                              : fmt::format(" with exit code {}", WEXITSTATUS(status));
  throw Error(kPartnerFailed, fmt::format("{} ended{} before it answered {}{}", name, how, to,
                                          started_ ? "" : "\n  it has to print a line of JSON for every state, and to flush it"));
}

bool Partner::take_line(std::string& line) {
  const std::size_t at = in_.find('\n');
  if (at == std::string::npos) return false;
  line = in_.substr(0, at);
  in_.erase(0, at + 1);
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return true;
}

// As much as goes in without waiting: a pipe that can be written to has room for PIPE_BUF bytes.
void Partner::write_some() {
  const ssize_t n = ::write(output_, out_.data(), std::min<std::size_t>(out_.size(), PIPE_BUF));
  if (n > 0) out_.erase(0, static_cast<std::size_t>(n));
  if (n < 0 && errno != EINTR && errno != EAGAIN) out_.clear();  // it hears no more, but may have said something
}

void Partner::read_some() {
  char bytes[16384];
  const ssize_t n = ::read(input_, bytes, sizeof bytes);
  if (n > 0) in_.append(bytes, static_cast<std::size_t>(n));
  if (n == 0 || (n < 0 && errno != EINTR && errno != EAGAIN)) heard_all_ = true;
}

std::string Partner::ask(const std::string& question, const std::string& to, const std::function<bool()>& stop) {
  say(question);
  const double until = timeout_ > 0 ? now() + timeout_ : INFINITY;
  std::string line;
  for (;;) {
    if (out_.empty() && take_line(line)) break;
    if (in_.size() > kLongestLine)
      throw Error(kPartnerFailed, in_.find('\n') < kLongestLine
                                      ? fmt::format("{} has sent {} bytes without reading {}", who(), in_.size(), to)
                                      : fmt::format("{}: its answer to {} is longer than {} bytes", who(), to, kLongestLine));
    if (heard_all_ && in_.find('\n') == std::string::npos) {
      if (stop()) throw Stopped{};
      gone(to);
    }
    pollfd ends[2] = {{heard_all_ ? -1 : input_, POLLIN, 0}, {out_.empty() ? -1 : output_, POLLOUT, 0}};
    const double left = until - now();
    if (left <= 0)
      throw Error(kPartnerFailed, fmt::format("{} {} within {:g} s (--bridge-timeout)", who(),
                                              out_.empty() ? "did not answer " + to : "did not read " + to, timeout_));
    poll(ends, 2, static_cast<int>(std::min(1e3 * left + 1, static_cast<double>(kSlice))));
    if (stop()) throw Stopped{};
    if (ends[1].revents) write_some();
    if (ends[0].revents) read_some();
  }
  started_ = true;
  return line;
}

}  // namespace mortise::bridge
