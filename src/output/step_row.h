#pragma once
#include <array>
#include <limits>

namespace mortise::output {

// One accepted time step (or load step): a row of /mortise/steps. What a run does not know stays NaN.
struct StepRow {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double step = 0;               // number of the step, from 1
  double time = 0;               // at its end [s]
  double dt = 0;                 // [s]
  double substeps = 1;           // > 1 after halvings of the step
  double newton_iterations = 0;  // all substeps and lag rounds
  double lag_iterations = 0;     // refreshes of lagged quantities (friction)
  double cg_iterations = 0;      // of all linear solves; 0 with the direct solver
  double line_search_halvings = 0;
  double regularised = 0;         // factorisations that needed a diagonal shift
  double first_order = 0;         // parts that an integrator of second order took by its first-order form
  double contacts = unknown;      // active contact pairs
  double min_gap = unknown;       // smallest gap [m]
  double residual = unknown;      // force residual at the end, of the body nearest its tolerance [N]
  double tolerance = unknown;     // what it had to be below [N]
  double lag_residual = unknown;  // residual with fresh lagged quantities [N]
  double energy = unknown;        // incremental potential at the end [J]
  double wall_ms = 0;             // [ms]
};

struct StepColumn {
  const char* name;
  const char* unit;
  double StepRow::*value;
  const char* description;
};

inline constexpr std::array<StepColumn, 17> step_columns = {{
    {"step", "1", &StepRow::step, "number of the step, from 1"},
    {"time", "s", &StepRow::time, "at the end of the step"},
    {"dt", "s", &StepRow::dt, "length of the step"},
    {"substeps", "1", &StepRow::substeps, "parts of the step; more than 1 after halvings"},
    {"newton_iterations", "1", &StepRow::newton_iterations, "of all parts and rounds of the step"},
    {"lag_iterations", "1", &StepRow::lag_iterations, "refreshes of lagged quantities (friction)"},
    {"cg_iterations", "1", &StepRow::cg_iterations, "of all linear solves; 0 with a direct solver"},
    {"line_search_halvings", "1", &StepRow::line_search_halvings, "of all Newton iterations"},
    {"regularised", "1", &StepRow::regularised, "factorisations that needed a diagonal shift"},
    {"first_order", "1", &StepRow::first_order, "parts of the step that BDF2 left to backward Euler, since it would have gained energy"},
    {"contacts", "1", &StepRow::contacts, "active contact pairs"},
    {"min_gap", "m", &StepRow::min_gap, "smallest gap"},
    {"residual", "N", &StepRow::residual, "force residual at the end of the body that is nearest its tolerance"},
    {"tolerance", "N", &StepRow::tolerance, "what the residual had to be below"},
    {"lag_residual", "N", &StepRow::lag_residual, "residual with fresh lagged quantities"},
    {"energy", "J", &StepRow::energy, "incremental potential at the end"},
    {"wall_ms", "ms", &StepRow::wall_ms, "time that the step took"},
}};

}  // namespace mortise::output
