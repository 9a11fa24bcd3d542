#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "base/error.h"
#include "sweep/sweep.h"

namespace mortise::sweep {

// How a row ended, or that it did not: from run.json, which a run writes last.
struct Status {
  enum class Is { missing, done, checks_failed, failed, stopped } is = Is::missing;
  int code = -1;        // exit code
  std::string message;  // of the error
  bool finished() const { return is == Is::done || is == Is::checks_failed; }
};
Status status_of(const std::string& row_folder);
const char* name_of(Status::Is is);

struct RunOptions {
  std::string folder;
  std::string device;  // as --device
  int threads = 0;     // of every row; 0: those of the machine shared out among the jobs
  int jobs = 1;        // rows at once
  bool no_render = false;
  std::vector<std::size_t> rows;   // which
  double walltime = 0, grace = 0;  // [s]: of all rows together; walltime 0: no end
  double checkpoint_every = 0;     // [s], of every row; 0 and below: as its scene says
};

// Runs the rows that are not finished, each as `mortise run` in a process of its own, which goes on from its checkpoint where there is one. `told`
// hears of every row that ends (or was finished already). SIGTERM and SIGINT are passed on to the rows, and so is the end of the walltime; returns
// Exit::stopped then, Exit::solve when a row failed, Exit::checks when checks of a row failed, else Exit::done. A finished row is never run again.
Exit run_rows(const Sweep& sweep, const RunOptions& options, const std::function<void(std::size_t row, const Status&, double seconds)>& told);

}  // namespace mortise::sweep
