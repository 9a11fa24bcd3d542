#pragma once
// How long the steps of a run will take, from the best that is known: what the scene took before on this machine, else its first steps and a scout of
// the others, else its sizes.
#include <optional>
#include <string>
#include <vector>

#include "cost/past.h"
#include "cost/scout.h"
#include "cost/speed.h"
#include "cost/trial.h"
#include "cost/work.h"

namespace mortise::cost {

// CPU time of an iteration of Newton's method by the sizes of the scene, on the machine that the numbers were fitted on [s].
double iteration_seconds(const Work& work);

struct Prediction {
  double seconds = 0, factor = 1;  // CPU time of the steps [s]; it is expected between seconds/factor and seconds*factor
  std::string from;                // where it comes from
};

// From the last run of this very scene, or the last of its kind; nothing where there is none.
std::optional<Prediction> from_past(const Work& work, const std::string& physics, const std::string& kind, const std::vector<Past>& runs);

// From the first steps; nothing where not one was taken.
std::optional<Prediction> from_trial(const Work& work, const Trial& trial);

// From the first steps and what the scout saw of those that follow, each: CPU time of an iteration where the trial did not come to one [s]. Nothing
// where the scout saw no more than the trial.
std::optional<Prediction> from_scout(const Work& work, const Trial& trial, const Scouted& scouted, double each);

Prediction from_sizes(const Work& work, const Speed& speed);

// "about 41 s of CPU time in the steps (20 s to 82 s): ..."
std::string text(const Prediction& prediction);

// All of that, for a scene whose engine has begun and is not needed any more; what is said where nothing can be.
std::string predict(const model::ModelInput& input, engine::Engine& engine);

// Keeps what a run took. cpu_seconds: of its steps.
void learn(const model::ModelInput& input, const std::string& linear_solver, int threads, long steps, long iterations, double cpu_seconds);

}  // namespace mortise::cost
