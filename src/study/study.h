#pragma once
// What a study is: a scene or a benchmark, ladders of settings, quantities of interest. Nothing in here runs anything.
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/types.h"

namespace mortise::study {

using Settings = std::vector<std::pair<std::string, std::string>>;  // paths and values of --set

// The values of a knob from coarse to fine, or alternatives of which none is finer.
struct Ladder {
  struct Step {
    Settings settings;  // several where knobs move together
    std::string label;  // "2 ms"
  };
  std::string name;
  std::vector<Step> steps;
  std::vector<double> sizes;  // falling with the error, one per step; empty: alternatives
  SourceLoc at;
};

// A way to compute the same: every ladder is climbed with each of them.
struct Method {
  std::string name;
  std::vector<std::string> without;  // effects that are left out
  std::vector<std::string> set;      // --set
  SourceLoc at{};
};

// A number that a run leaves (README.md says what there is).
struct Quantity {
  std::string name;
  std::string value;                  // group/name of a scalar or vector, steps/column, or a field of points of `body`
  std::string axis;                   // component of a vector: x, y, z or size
  std::string body, over = "";        // of its points: mean, max, min, integral, area, percentile
  std::optional<Vec3> point;          // or at this place of the body at rest [m]
  double percent = NAN;               // of `percentile`
  std::string when = "end";           // end, start, largest, smallest, mean, sum, range
  std::optional<double> at;           // or at this time [s]
  std::optional<double> reference;    // its right value, SI
  double uncertainty = 0, scale = 0;  // of that value; errors are shares of the reference or of this, whichever is larger
  SourceLoc place{};                  // where it is written
  bool of_history() const { return at || (when != "end" && when != "start"); }
};

struct Study {
  std::string name;
  std::string scene;             // path of a scene ...
  std::string benchmark;         // ... or name of a benchmark
  std::vector<std::string> set;  // --set of all runs
  std::vector<Ladder> ladders;
  std::vector<Method> methods;  // one without a name where the study has none
  std::vector<Quantity> quantities;
  bool one_at_a_time = false;  // else all combinations: the first ladder along a curve, the others from curve to curve
  Settings over_resolved;      // of the run that others are compared with where ladders have no limit
  SourceLoc over_resolved_at{};
  int repeats = 1;    // runs of everything; the fastest counts
  double limit = 0;   // CPU time of a run after which it counts as failed [s]; 0: none
  double budget = 0;  // CPU time of all runs together [s]; 0: all that is planned is run
};

}  // namespace mortise::study
