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
  Settings settings(int level) const;
  std::string label(int level) const;  // "mesh / 1.4"
};

// Edge lengths of all bodies, and with them the thickness of contact layers where the scene gives it (what is left out follows the mesh): layers that
// get thinner on the same mesh get stiffer beside it, until pressures scatter from node to node, and both together cost fewer runs than each by itself.
// The time step, or load steps where friction remembers them.
std::vector<AutoKnob> auto_knobs(const Params& scene);

}  // namespace mortise::study
