#pragma once
// The scene's whole course with coarser meshes: where contact begins, bodies are dragged or lock, and how much harder steps are then.
#include <string>
#include <vector>

#include "model/input.h"

namespace mortise::cost {

struct Passed {
  double iterations = 0;  // of Newton's method
  double seconds = 0;     // CPU time [s]
};

struct Scouted {
  double edges = 1;           // lengths, times those of the scene
  std::vector<Passed> steps;  // up to the end of each; empty: it could take none
  Passed until(double step) const;
};

// How many times as long edges have to be for the course to take about `most` seconds, where the scene itself takes `expected`; 1: they cannot be
// longer.
double coarse_enough(const model::ModelInput& input, const std::string& linear_solver, double expected, double most);

// Takes the course for no more than `most` seconds of CPU time. No steps where there is no such mesh; one that fails ends it.
Scouted scout(const Params& scene, double edges, double most);

}  // namespace mortise::cost
