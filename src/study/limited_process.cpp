#include "study/limited_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <thread>

#include "base/process.h"
#include "run/signals.h"

namespace mortise::study {
namespace {

double cpu_of(pid_t child) {
  clockid_t clock{};
  timespec t{};
  if (clock_getcpuclockid(child, &clock) != 0 || clock_gettime(clock, &t) != 0) return 0;
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Its steps begin when there is a file for their fields. What is written meanwhile is not theirs: a run is ended when it has surely taken too long,
// and judged by what it says itself otherwise.
constexpr double kSurely = 1.5, kSurelySeconds = 1;

}  // namespace

// In a process group of its own, so that what a terminal sends reaches it through here, once.
Ended run_limited(const std::vector<std::string>& command, const std::string& log, const Most& most, const std::string& fields) {
  const pid_t child = start_program(command, log, log, [parent = getpid()] {
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(127);
    if (const int none = open("/dev/null", O_RDONLY); none >= 0) dup2(none, STDIN_FILENO);
  });
  bool passed_on = false;
  Over over = Over::none;
  double begin = NAN;  // of the steps
  for (;;) {
    int how = 0;
    rusage used{};
    const pid_t ended = wait4(child, &how, WNOHANG, &used);
    if (ended == child) return {code_of(how), cpu_seconds(used), WIFSIGNALED(how) ? over : Over::none};
    const double cpu = cpu_of(child);
    if (std::isnan(begin) && std::filesystem::exists(fields)) begin = cpu;
    if (most.process > 0 && cpu > most.process) over = Over::process;
    if (most.steps > 0 && cpu - begin > kSurely * most.steps + kSurelySeconds) over = Over::steps;
    if (over != Over::none) kill(child, SIGKILL);
    if (run::stop_asked() && !passed_on) kill(child, SIGTERM), passed_on = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

}  // namespace mortise::study
