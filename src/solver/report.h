#pragma once
#include <map>
#include <string>
#include <vector>

#include "base/types.h"
#include "effects/failure.h"
#include "solver/trace.h"

namespace mortise::solver {

// Seconds and calls per effect and phase ("elasticity", "assemble"); the solver's own phases stand under "solver".
struct Clock {
  std::map<std::pair<std::string, std::string>, std::pair<double, long long>> seconds;
};

// What one step cost and how well it was solved.
struct StepReport {
  Index step = 0;   // number of the finished step, from 0
  double time = 0;  // at its end
  double dt = 0;
  Index substeps = 1;                // > 1 after halvings
  Index newton = 0;                  // Newton iterations, all substeps and lag rounds
  Index lag = 0;                     // refreshes of lagged quantities
  Index cg = 0;                      // linear iterations (0 with the direct solver)
  Index line_search = 0;             // halvings in line searches
  Index softened = 0;                // directions for which negative curvature had to be taken away
  Index first_order = 0;             // substeps that an integrator of second order took by its first-order form
  Index regularised = 0;             // factorisations that needed a diagonal shift
  double alpha = 1;                  // smallest accepted step length
  double residual = 0;               // force residual at the end, of the body nearest its tolerance [N]
  double tolerance = 0;              // what it had to be below [N]
  double relative_residual = 0;      // worst body's residual over the forces on it, where that is more than rounding
  double lag_residual = 0;           // residual with fresh lagged quantities [N]
  double relative_lag_residual = 0;  // the same over the forces
  double energy = 0;                 // potential Phi at the end [J]
  double wall = 0;                   // [s]
  std::vector<Iterate> trace;        // when asked for
};

// A report of every environment; or one of all, which counts what they did together.
class StepReports {
 public:
  StepReports(StepReport& one) : first_(&one), size_(1), stride_(0) {}
  StepReports(std::vector<StepReport>& all) : first_(all.data()), size_(all.size()), stride_(1) {}
  StepReport& operator[](Index env) const { return first_[stride_ * static_cast<std::size_t>(env)]; }
  std::size_t size() const { return size_; }
  // What they are now, and again.
  std::vector<StepReport> kept() const { return {first_, first_ + size_}; }
  bool shared() const { return stride_ == 0; }

 private:
  StepReport* first_;
  std::size_t size_, stride_;
};

using effects::Failure;

}  // namespace mortise::solver
