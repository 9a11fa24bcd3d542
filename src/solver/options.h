#pragma once
#include <string>

#include "base/params.h"

namespace mortise::solver {

struct Options {
  // A step is done when the residual of every body is at most max(force_tolerance [N], relative_tolerance * forces on it): convergence.h.
  double force_tolerance = 0;
  double relative_tolerance = 1e-6;
  double step_tolerance = 0;  // and, when > 0, the last Newton step moved no block further than this [m]
  Index iterations = 100;     // Newton iterations per solve before the step counts as failed
  Index halvings = 6;         // how often a failed step may be halved
  std::string linear = "auto";
  bool batch = false;          // the scene has `environments`: whether one of them or all run, they are solved alike
  double cg_tolerance = 1e-8;  // relative true residual, the smallest asked for when cg_forcing
  bool cg_forcing = true;      // solve the linear systems only as exactly as Newton's progress deserves
  std::string preconditioner = "auto";
  Index cg_iterations = 10000;
  // Lagged quantities (friction) are refreshed until the force residual with fresh values is at most lag_tolerance times
  // the largest force, at most lag_iterations times; in between, Newton stops at a tenth of that.
  double lag_tolerance = 1e-3;
  Index lag_iterations = 20;

  bool trace = false;  // keep what every iteration did

  // Time: dynamic (dt in s) or static (pseudo-time 0..1 over `steps`).
  bool is_static = false;
  double dt = 0;
  Index steps = 0;
};

Options read_options(const Params& scene);

}  // namespace mortise::solver
