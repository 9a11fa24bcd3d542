#pragma once
// Where the error of a number of one run comes from: what is to be added to it because of the mesh, of the length of steps, of the gap that contact
// leaves, and of what Newton's method left. Of static scenes from one adjoint solve per quantity with the last Jacobian; elsewhere all but the mesh's
// part from scenes that go beside the run (followed_budget.h).
#include <optional>
#include <string>
#include <vector>

#include "engine/engine.h"
#include "model/input.h"
#include "run/options.h"
#include "study/run_study.h"

namespace mortise::study {

inline constexpr const char *kMeshPart = "mesh of soft bodies", *kStepsPart = "length of time steps", *kGapPart = "gap that contact leaves",
                            *kLoadStepsPart = "length of load steps", *kBetweenPart = "what lies between steps",
                            *kSolutionPart = "Newton's method, linear systems, lag", *kFacetsPart = "facets of round surfaces, integration";
inline constexpr const char* kNotReliable = "not reliable";  // so begins why there is no number where one was found

struct ErrorPart {
  std::string source;
  double error = NAN;   // what is to be added to the number; NaN: not estimated
  std::string why_not;  // then
  double found = NAN;   // the error that was found, relied on or not
  double hidden = 0;    // of the mesh: what is too stiff and what is too soft, together, where one hides the other
};

struct QuantityBudget {
  double value = NAN;
  double scale = 0;              // what a number of its kind is large against: of a force all that holds the body, of a way the longest
  std::string why_not;           // nothing is known of this one
  std::vector<ErrorPart> parts;  // of the mesh first
  void judge(double of_value);   // sets the value; a part of the mesh that cannot be relied on becomes "not reliable"
  double sum() const;            // of what is estimated
  bool complete() const;
  double share() const;  // of all that was found, relied on or not, of the number, or of what it is large against; NaN where nothing was
};

struct ErrorBudget {
  std::vector<QuantityBudget> of;         // the quantities
  double solve_seconds = 0, seconds = 0;  // CPU time of the steps, and of the estimates [s]; of scenes that are followed all is of the steps
  std::string note;                       // on all of it
  bool exact = true;                      // J^T lacked nothing
};

// Of what the largest or smallest value of a quantity may be off by between steps, a share of it; empty: nothing.
std::string what_lies_between(double share);

// Of the state that the engine's last step led to; values are left out.
ErrorBudget budget_of(engine::Engine& engine, const model::ModelInput& input, const std::vector<Quantity>& quantities);

// Of a run that has ended with all of its steps, for its certificate: the scene's `quantities` with values from its field file, as a JSON array.
// What cannot be told is told, as without an engine, when the run was continued after its last step; a quantity that nothing reports is warned of: it
// does not undo hours of work.
run::Estimated budget_of_run(engine::Engine* engine, const model::ModelInput& input, const std::string& fields);

// Runs the scene. Throws Error(Exit::usage) for scenes of which nothing can be said.
ErrorBudget find_error_budget(const Study& study, const Place& place);

std::string budget_table(const Study& study, const ErrorBudget& budget);
std::string budget_entries(const std::vector<Quantity>& quantities, const ErrorBudget& budget);  // a JSON array
std::string budget_json(const Study& study, const ErrorBudget& budget);

}  // namespace mortise::study
