#pragma once
// What a run says itself of the errors of its numbers: the error budget of its certificate (error_budget.h).
#include <optional>
#include <string>
#include <vector>

#include "study/accuracy_knobs.h"
#include "study/accuracy_model.h"

namespace mortise::study {

struct GoalBudget {
  double mesh = 0, gap = 0;  // what is to be added to the number; infinite of a mesh that is too coarse to tell
};

// Of each of the quantities; nothing where one of them has no budget, so that only other runs can tell.
std::optional<std::vector<GoalBudget>> goal_budgets(const std::string& certificate, const std::vector<Quantity>& quantities);

// Why a certificate has C or worse: of forces and motions, or, where one of the quantities is of fields, of all; empty where it has not.
std::string doubt_of(const std::string& certificate, const std::vector<Quantity>& quantities);

// Do budgets tell of all that these knobs refine?
bool budgets_tell(const std::vector<AutoKnob>& knobs);

// What they say of each knob. The gap falls with the layer, which follows the mesh where it is no knob.
std::vector<Climb> climbs_of_budgets(const std::vector<AutoKnob>& knobs, const std::vector<GoalBudget>& budgets);

}  // namespace mortise::study
