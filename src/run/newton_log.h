#pragma once
// newton.csv: one line per Newton iteration, for scenes with `solver: {trace: true}`. A resumed run continues it.
#include <fmt/format.h>

#include <fstream>
#include <string>

#include "base/error.h"
#include "solver/report.h"

namespace mortise::run {

class NewtonLog {
 public:
  void step(const std::string& path, const solver::StepReport& r) {
    if (r.trace.empty()) return;
    if (!file_.is_open()) {
      file_.open(path, std::ios::app);
      if (file_.tellp() == 0) file_ << "step,time,dt,round,iteration,residual,tolerance,energy,concave,step_length,alpha,where\n";
    }
    for (const solver::Iterate& i : r.trace)
      file_ << fmt::format("{},{:.9g},{:.6g},{},{},{:.6g},{:.6g},{:.15g},{:.4g},{:.6g},{:.6g},{}\n", r.step + 1, i.time, i.dt, i.round, i.iteration, i.residual, i.tolerance, i.energy,
                           i.concave, i.step, i.alpha, i.where);
    if (!file_.flush()) throw Error(Exit::file, "could not write '" + path + "'");
  }

 private:
  std::ofstream file_;
};

}  // namespace mortise::run
