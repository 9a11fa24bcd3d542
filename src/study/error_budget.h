#pragma once
// Where the error of a number of one run comes from: what is to be added to it because of the mesh, of the gap that contact leaves, of time steps,
// and of what Newton's method left (error_watch.h).
#include <memory>
#include <string>
#include <vector>

#include "model/input.h"
#include "run/options.h"
#include "study/run_study.h"

namespace mortise::study {

struct ErrorPart {
  std::string source;
  double error = NAN;   // what is to be added to the number; NaN: not estimated
  std::string why_not;  // then
};

struct QuantityBudget {
  double value = NAN;
  std::string why_not;  // nothing is known of this one
  std::vector<ErrorPart> parts;
  double sum() const;  // of what is estimated
  bool complete() const;
};

struct ErrorBudget {
  std::vector<QuantityBudget> of;         // the quantities
  double solve_seconds = 0, seconds = 0;  // CPU time of the steps, and of the estimates [s]
};

// Goes beside a run, for its certificate: the scene's `quantities`. What cannot be told is told.
std::unique_ptr<run::Estimate> estimate_beside(const run::EstimateOf& run);

// Runs the scene. Throws what a run throws.
ErrorBudget find_error_budget(const Study& study, const Place& place);

std::string budget_table(const Study& study, const ErrorBudget& budget);
std::string budget_entries(const std::vector<Quantity>& quantities, const ErrorBudget& budget);  // a JSON array
std::string budget_json(const Study& study, const ErrorBudget& budget);

}  // namespace mortise::study
