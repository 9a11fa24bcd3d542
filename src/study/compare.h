#pragma once
// From values to errors: references, Pareto front, knee, times at the same error.
#include "study/plan.h"
#include "study/results.h"

namespace mortise::study {

// The references of all quantities and the points of all curves. results: of the plan's runs, in their order; over: of the over-resolved run, if
// there was one. Throws Error(Exit::solve) where there is nothing to compare with.
void compare(const Plan& plan, const RunResult* over, Results& results);

// Whether a quantity has no reference but by an over-resolved run.
bool needs_over_resolved(const Plan& plan, const Results& results);

// Marks fronts and knees, quantity by quantity. Errors below the reference's uncertainty count as much as that.
void mark_best(std::vector<Point>& points, const std::vector<Reference>& references);

// CPU time at which a curve reaches an error, between the two neighbours along its ladder where both axes are logarithmic; NaN where no two points
// of it lie on both sides.
double time_at(const std::vector<const Point*>& curve, double error);

// The same on the front of a quantity, where every point stands for all slower ones.
double front_time_at(const std::vector<Point>& points, std::size_t quantity, double error);

// The points of a quantity, curve by curve in the order of the ladder.
std::vector<std::pair<std::string, std::vector<const Point*>>> curves_of(const std::vector<Point>& points, std::size_t quantity);

}  // namespace mortise::study
