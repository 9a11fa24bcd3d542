#pragma once
// An error budget of any quantity of a run, in motion or not: beside it go scenes that mend what it is wrong by, by a share of it, and are followed
// to first order (solver/follow.cpp). What they come to differ by along the whole way, over that share, is what is to be added.
#include "scene/scene.h"
#include "study/error_budget.h"

namespace mortise::study {

// Times are of the whole run.
ErrorBudget followed_budget(const scene::Scene& scene, const std::vector<Quantity>& quantities, const Place& place);

}  // namespace mortise::study
