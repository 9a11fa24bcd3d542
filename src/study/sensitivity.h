#pragma once
// What quantities hang on: derivatives with respect to numbers of the scene, along the whole run, from linearised equations (solver/follow.cpp).
#include <cmath>
#include <string>
#include <vector>

#include "study/parameter.h"
#include "study/run_study.h"

namespace mortise::study {

// dQ / d ln p of one quantity and one parameter: what Q changes by per share that p grows by. NaN: unknown.
struct Derivative {
  double below = NAN, above = NAN;  // from the smaller and from the larger value
  double central() const { return (below + above) / 2; }
  double uncertainty() const { return std::abs(above - below) / 2; }
  bool kink = false;  // they differ so much that there may be no derivative
};

struct Sensitivity {
  Parameter parameter;
  std::string refused;         // why there is none
  std::vector<Derivative> of;  // the quantities
};

struct Sensitivities {
  std::vector<double> values;  // of the quantities
  std::vector<Sensitivity> parameters;
  double seconds = 0;  // CPU time of the steps, of the run and of all that went beside it [s]
};

// paths: of numbers of the scene, or the word "all". Throws Error(Exit::usage), and what a run throws.
Sensitivities find_sensitivities(const Study& study, const std::vector<std::string>& paths, const Place& place);

std::string sensitivity_table(const Study& study, const Sensitivities& found);
std::string sensitivity_csv(const Study& study, const Sensitivities& found);

}  // namespace mortise::study
