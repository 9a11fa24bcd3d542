#pragma once
// `mortise run --accuracy peak=1%`: refines what a scene's numbers hang on until their estimated errors are small enough.
#include <functional>
#include <string>
#include <vector>

#include "study/accuracy_model.h"
#include "study/execute.h"
#include "study/results.h"

namespace mortise::study {

struct Goal {
  std::string quantity;  // its name in the scene
  double share = 0;      // of its size
};

// "peak=1%". Throws Error(Exit::usage).
Goal goal_of_flag(const std::string& text);
// The quantities that goals name, out of the scene's. Throws Error(Exit::usage).
std::vector<Quantity> quantities_of_goals(const Params& scene, const std::vector<Goal>& goals);

struct Attempt {
  RunResult run;
  Levels levels;
  std::vector<double> estimates;  // of the errors of all quantities, in their units, where its neighbours were run
};

struct Accuracy {
  std::vector<Goal> goals;
  std::vector<Quantity> quantities;  // those of the goals
  std::vector<std::string> knobs;
  std::vector<Climb> climbs;  // around the chosen one
  std::vector<Attempt> attempts;
  std::size_t chosen = 0;  // of the attempts: the one that reaches all goals, else the one that comes nearest
  bool reached = false;
  std::string why_not;             // then
  std::string how;                 // estimates were found
  std::string doubt;               // why the certificate of the chosen one has C or worse of what is asked for; empty: it has not
  std::vector<std::string> notes;  // knobs that failed
  double seconds = 0;              // CPU time of all runs, those of earlier attempts included
  Settings settings;               // of the chosen one
  double goal(std::size_t quantity, double value) const;  // the error that is asked for of a number of that size, in its units
};

struct Wanted {
  std::string scene;
  std::vector<std::string> set;
  std::vector<Goal> goals;
  double most = 0;  // CPU time of all runs [s]
};

// Runs go to place.folder/runs, as a study's do: what was run is not run again. Throws Error(Exit::usage) where a goal or the scene cannot be looked
// for, Error(Exit::solve) where the scene itself fails, Error(Exit::stopped).
Accuracy find_accuracy(const Wanted& wanted, const Place& place, const std::function<void(const Attempt&, const std::vector<Quantity>&)>& told);

std::string accuracy_table(const Accuracy& found);
std::string accuracy_json(const Accuracy& found);

}  // namespace mortise::study
