#pragma once
// What each knob of a run still moves, by itself. Errors of several knobs may cancel by luck: then a value is near to the truth, and no finer setting
// of one of them makes it better. Such a run is no better than its knobs are.
#include <string>
#include <vector>

#include "study/plan.h"
#include "study/results.h"

namespace mortise::study {

// Limit of a quantity along a curve, of the runs that did not fail; steps that gave the same to the last digit count once.
Limit limit_along(const Curve& curve, const Results& results, std::size_t quantity);
bool same_run(const RunResult& a, const RunResult& b);

struct Correction {
  std::string knob;
  double by;  // what is to be added for it [the quantity's unit]
};

// Of a run with these steps of these curves (indices into plan.curves), all other knobs as the scene has them; one knob at a time.
std::vector<Correction> corrections(const Plan& plan, const Results& results, std::size_t quantity, std::size_t method,
                                    const std::vector<OnCurve>& steps);
// Of a run of combinations: along its curve, and from the curve's limit to the reference.
std::vector<Correction> corrections(const Plan& plan, const Results& results, std::size_t quantity, const OnCurve& at, double reference);

double root_of_squares(const std::vector<Correction>& all);

// "mesh +38.7 % and d_hat -43.9 %", more or less than it should be, where they cancel: where together they are well below the root of their squares;
// else empty.
std::string cancelling(const std::vector<Correction>& all, double scale);

// The settings of a run with all refining knobs moved together, each by its first step that is better than the scene as it is: what it differs from
// the sum of its knobs by is their interaction. No steps where fewer than two knobs refine.
std::vector<OnCurve> joint_steps(const Plan& plan, const Results& results);
Planned joint_run(const Study& study, const Plan& plan, const std::vector<OnCurve>& steps);

// What the interaction of all ladders may be at their limits: that of the joint run, as much larger as the products of the knobs' changes are there
// (and a quarter more, as those of a limit are); where there was none, these products over the quantity itself.
double interaction(const Plan& plan, const Results& results, std::size_t quantity);

}  // namespace mortise::study
