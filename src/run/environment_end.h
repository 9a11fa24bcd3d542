#pragma once
#include <string>
#include <vector>

#include "scene/environments.h"

namespace mortise::run {

// What is known of one environment of a batch when it has ended, or the batch has.
struct EnvironmentEnd {
  std::vector<scene::Drawn> drawn;
  int code = -1;                           // Exit; -1: it never began
  std::string message;                     // of a failure
  double wall = 0, cpu = 0;                // [s], of its process in this command
  long long memory = 0;                    // most resident memory of its process [B]
  long steps = 0, frames = 0, newton = 0;  // that its files hold; Newton iterations
  std::string grade, reason;               // of its certificate, of the worst episode's
  std::string grade_forces;                // of forces and motions alone
  std::vector<std::string> runs;           // folders of its runs: its own, or those of its episodes

  bool done() const { return code == static_cast<int>(Exit::done) || code == static_cast<int>(Exit::checks); }
  bool stopped() const { return code == static_cast<int>(Exit::stopped); }
  bool failed() const { return code >= 0 && !done() && !stopped(); }
  const char* status() const {
    if (code < 0) return "waiting";
    if (code == static_cast<int>(Exit::checks)) return "checks failed";
    return done() ? "done" : stopped() ? "stopped" : "failed";
  }
};

// Adds steps, frames and grade of one run.
void read_run(const std::string& folder, EnvironmentEnd& end);
// Of all that it left in its folder.
void read_end(const std::string& folder, EnvironmentEnd& end);

struct BatchEnd {
  std::string scene_name, scene_sha256;
  long seed = 0;
  int threads = 1;
  Exit code = Exit::done;
  std::string message;
  double wall = 0;  // [s]
};

// environments.csv: a line per environment with how it ended and what was drawn for it. environments.json: the same, and their sum.
std::string environments_csv(const std::vector<EnvironmentEnd>& all);
std::string environments_json(const std::vector<EnvironmentEnd>& all, const BatchEnd& end);

}  // namespace mortise::run
