#pragma once
// What can be refined of a scene without being told.
#include <string>
#include <vector>

#include "base/params.h"
#include "model/input.h"
#include "study/study.h"

namespace mortise::study {

struct AutoKnob {
  std::string name;
  double ratio = 0.5, dearer = 1;  // as in Climb
  bool mesh = false;               // its size is that of the mesh that came out, not the one asked for
  struct Path {
    std::string path;
    double base;         // as the scene has it, SI
    bool whole = false;  // a whole number, that grows
  };
  std::vector<Path> paths;
  std::vector<std::string> sources{};  // of errors (error_budget.h) that it makes smaller
  Settings settings(int level) const;
  std::string label(int level) const;  // "mesh / 1.4"
};

// Edge lengths of all bodies together; the contact layer, where the scene gives its thickness (what is left out follows the mesh); the time step, or
// load steps where friction remembers them.
std::vector<AutoKnob> auto_knobs(const Params& scene);

}  // namespace mortise::study
