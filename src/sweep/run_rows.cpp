#include "sweep/run_rows.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/process.h"
#include "output/atomic_file.h"
#include "run/signals.h"

namespace fs = std::filesystem;

namespace mortise::sweep {
namespace {

using Time = std::chrono::steady_clock;

struct Job {
  std::size_t row;
  Time::time_point begin;
};

// In a process group of its own, so that what a terminal sends reaches it through here, once. Its messages go to FOLDER/0007.log.
pid_t start(const std::vector<std::string>& arguments, const std::string& log) {
  return start_program(arguments, log, log, [parent = getpid()] {
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);     // a row stands that; one that nobody waits for would hold its folder
    if (getppid() != parent) _exit(127);  // it was too late for that
    if (const int none = open("/dev/null", O_RDONLY); none >= 0) dup2(none, STDIN_FILENO);
  });
}

std::vector<std::string> command(const Sweep& sweep, const RunOptions& o, std::size_t row) {
  std::vector<std::string> out{own_program(), "run", sweep.scene, "-o", row_folder(o.folder, row), "--resume=auto", "--device", o.device};
  if (o.threads > 0) out.insert(out.end(), {"--threads", std::to_string(o.threads)});
  if (o.no_render) out.push_back("--no-render");
  for (const std::string& set : sweep.rows[row].overrides(sweep.set)) out.insert(out.end(), {"--set", set});
  if (o.checkpoint_every > 0) out.insert(out.end(), {"--checkpoint-every", fmt::format("{} s", o.checkpoint_every)});
  return out;
}

Exit worst(Exit a, const Status& b) {
  if (b.is == Status::Is::stopped || a == Exit::stopped) return Exit::stopped;
  if (b.is == Status::Is::failed || b.is == Status::Is::missing || a == Exit::solve) return Exit::solve;
  return b.is == Status::Is::checks_failed ? Exit::checks : a;
}

}  // namespace

Status status_of(const std::string& row_folder) {
  const std::string path = row_folder + "/run.json";
  if (!fs::exists(path)) return {};
  const auto j = nlohmann::json::parse(output::read_file(path), nullptr, false);
  if (j.is_discarded() || !j.contains("exit_code")) return {};
  Status s{Status::Is::failed, j["exit_code"], j.value("message", "")};
  if (s.code == static_cast<int>(Exit::done)) s.is = Status::Is::done;
  if (s.code == static_cast<int>(Exit::checks)) s.is = Status::Is::checks_failed;
  if (s.code == static_cast<int>(Exit::stopped)) s.is = Status::Is::stopped;
  return s;
}

const char* name_of(Status::Is is) {
  constexpr const char* kNames[] = {"missing", "done", "checks failed", "failed", "stopped"};
  return kNames[static_cast<int>(is)];
}

Exit run_rows(const Sweep& sweep, const RunOptions& o, const std::function<void(std::size_t, const Status&, double)>& told) {
  run::install_signal_handlers();
  std::map<pid_t, Job> jobs;
  Exit result = Exit::done;
  std::size_t next = 0;
  bool passed_on = false;
  const Time::time_point begin = Time::now();
  const auto stop = [&] {
    return run::stop_asked() || (o.walltime > 0 && std::chrono::duration<double>(Time::now() - begin).count() > o.walltime - o.grace);
  };
  while (next < o.rows.size() || !jobs.empty()) {
    while (!stop() && next < o.rows.size() && jobs.size() < static_cast<std::size_t>(o.jobs)) {
      const std::size_t row = o.rows[next++];
      if (const Status before = status_of(row_folder(o.folder, row)); before.finished()) {
        result = worst(result, before);
        told(row, before, 0);
        continue;
      }
      jobs[start(command(sweep, o, row), row_folder(o.folder, row) + ".log")] = {row, Time::now()};
    }
    if (stop()) {
      if (next < o.rows.size() || !jobs.empty()) result = Exit::stopped;
      next = o.rows.size();
      if (!passed_on)
        for (const auto& [child, job] : jobs) ::kill(child, SIGTERM);
      passed_on = true;
    }
    int how = 0;
    const pid_t child = waitpid(-1, &how, WNOHANG);
    if (child <= 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      continue;
    }
    const auto job = jobs.find(child);
    if (job == jobs.end()) continue;
    const std::string folder = row_folder(o.folder, job->second.row);
    Status now = status_of(folder);
    // What ended before there was a folder, or by a signal, left no run.json.
    const int code = code_of(how);
    if (now.is == Status::Is::missing || (now.finished() && code != now.code)) now = {Status::Is::failed, code, "see " + folder + ".log"};
    result = worst(result, now);
    told(job->second.row, now, std::chrono::duration<double>(Time::now() - job->second.begin).count());
    jobs.erase(job);
  }
  return result;
}

}  // namespace mortise::sweep
