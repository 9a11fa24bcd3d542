#include "base/child.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <new>

#include "base/cage.h"
#include "base/error.h"

namespace mortise {
namespace {

constexpr int kNoMemory = 40;  // exit code of the child

// What the child leaves in a file without a name: a byte ('=' value, '!' error), the exit code of the error, the text.
class ResultFile {
 public:
  ResultFile() : file_(memfd_create("mortise", MFD_CLOEXEC)) {
    if (file_ < 0) throw Error(Exit::file, std::string("cannot make a file in memory: ") + std::strerror(errno));
  }
  ~ResultFile() { close(file_); }
  ResultFile(const ResultFile&) = delete;
  ResultFile& operator=(const ResultFile&) = delete;

  int file() const { return file_; }
  bool write(const std::string& bytes) const {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t n = ::write(file_, bytes.data() + done, bytes.size() - done);
      if (n < 0 && errno != EINTR) return false;
      if (n > 0) done += static_cast<std::size_t>(n);
    }
    return true;
  }
  std::string read() const {
    std::string bytes(static_cast<std::size_t>(std::max<off_t>(lseek(file_, 0, SEEK_END), 0)), '\0');
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t n = pread(file_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
      if (n == 0 || (n < 0 && errno != EINTR)) return {};
      if (n > 0) done += static_cast<std::size_t>(n);
    }
    return bytes;
  }

 private:
  int file_;
};

// Private memory of this process that can be written to [bytes]: what RLIMIT_DATA counts.
std::size_t data_size() {
  std::ifstream in("/proc/self/statm");
  std::size_t pages = 0;
  for (int k = 0; k < 6; ++k) in >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

void restrict_child(ChildLimits limits, [[maybe_unused]] int result) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // who ends the program ends this too
  for (int s : {SIGALRM, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGINT, SIGTERM, SIGUSR1}) std::signal(s, SIG_DFL);
  alarm(limits.seconds);
  const rlim_t bytes = data_size() + limits.bytes;
  const rlimit data{bytes, bytes}, no_core{0, 0};
  setrlimit(RLIMIT_DATA, &data);
  setrlimit(RLIMIT_CORE, &no_core);
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
#if !defined(__SANITIZE_ADDRESS__)  // whose own calls would need more
  lock_into_cage(result);
#endif
}

// _exit: the parent's files are not this process's to flush, nor its objects to destroy.
[[noreturn]] void run_child(const ResultFile& result, ChildLimits limits, const std::function<std::string()>& job) {
  restrict_child(limits, result.file());
  std::string reply;
  try {
    reply = std::string("=") + '\0' + job();
  } catch (const Error& e) {
    reply = std::string("!") + static_cast<char>(e.code()) + e.what();
  } catch (const std::bad_alloc&) {
    _exit(kNoMemory);
  } catch (const std::exception& e) {
    reply = std::string("!") + static_cast<char>(Exit::scene) + e.what();
  }
  _exit(result.write(reply) ? 0 : kNoMemory);
}

int wait_for(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

std::string in_child(const std::string& what, ChildLimits limits, const std::function<std::string()>& job, Exit blame) {
  const ResultFile result;
  const pid_t child = fork();
  if (child < 0) throw Error(Exit::file, "cannot start a process: " + std::string(std::strerror(errno)));
  if (child == 0) run_child(result, limits, job);

  const int status = wait_for(child);
  const auto fail = [&](const std::string& reason) { throw Error(blame, what + ": " + reason); };
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM) fail("its reader is not done after " + std::to_string(limits.seconds) + " s");
  if (WIFSIGNALED(status)) fail(std::string("its reader crashes on it (") + strsignal(WTERMSIG(status)) + ")");
  if (WEXITSTATUS(status) == kNoMemory) fail("its reader needs more than " + std::to_string(limits.bytes >> 20) + " MiB of memory");
  const std::string reply = result.read();
  if (WEXITSTATUS(status) != 0 || reply.size() < 2) fail("its reader ends without a result");
  if (reply[0] == '!') throw Error(static_cast<Exit>(reply[1]), reply.substr(2));
  return reply.substr(2);
}

}  // namespace mortise
