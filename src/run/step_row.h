#pragma once
#include "output/step_row.h"
#include "run/progress.h"

namespace mortise::run {

inline output::StepRow step_row(const solver::StepReport& report, const audit::ContactFigures& contact) {
  output::StepRow row;
  row.step = report.step + 1, row.time = report.time, row.dt = report.dt, row.substeps = report.substeps;
  row.newton_iterations = report.newton, row.lag_iterations = report.lag, row.cg_iterations = report.cg;
  row.line_search_halvings = report.line_search, row.regularised = report.regularised, row.first_order = report.first_order;
  row.contacts = contact.pairs, row.min_gap = contact.min_gap;
  row.residual = report.residual, row.tolerance = report.tolerance, row.lag_residual = report.lag_residual;
  row.energy = report.energy, row.wall_ms = report.wall * 1e3;
  return row;
}

}  // namespace mortise::run
