#pragma once
// What is known of a scene's knobs while an accuracy is looked for: how its numbers change along each, and what each still leaves. No runs in here.
#include <cmath>
#include <string>
#include <vector>

#include "study/limit.h"

namespace mortise::study {

// A run with a knob at a level: 0 at the run that others are compared with, 1, 2, ... finer, -1, -2 coarser; all other knobs as there.
struct Rung {
  int level = 0;
  double size = 1;             // of the mesh, the step, ... over that of level 0
  std::vector<double> values;  // of the quantities
  double cost = 1;             // CPU time over that of level 0
};

// What one run says that it lacks because of a knob (error_budget.h), and the order at which that falls.
struct Part {
  std::vector<double> left;  // per quantity, at level 0
  double order = 1;
};

struct Climb {
  std::string name;
  std::vector<Rung> rungs;  // levels rise
  double ratio = 0.5;       // size from level to level
  double dearer = 1;        // cost ~ size^-dearer, where runs have not told
  int finest = 0;           // no finer level is to be tried
  std::vector<Part> parts;  // where they are known nothing else is asked
  bool blind = false;       // all of its runs had the same mesh: nothing is known

  double size(int level) const;
  double cost(int level) const;
  // As of ladders (limit.h). Where no order is seen, or a higher one than methods have (tuning::kTrustedOrder), the last value, known no better than
  // it differs from the two before: with sizes in the ratio of root two, by what an error of order 1 would be.
  Limit limit(std::size_t quantity) const;
  double value(std::size_t quantity, int level) const;  // from the limit where no run has it
  double left(std::size_t quantity, int level) const;   // what is to be added to it for this knob
  double error(std::size_t quantity, int level) const;  // the size of that with its uncertainty, never less than it
  bool settles(std::size_t quantity) const;             // a budget or a limit is behind that, and not what runs scatter by
  void add(Rung rung);
  // The same ladder around a run with this knob at `level` and others elsewhere too, whose values these are: errors of knobs add up to first order.
  Climb around(int level, const std::vector<double>& values) const;
};

using Levels = std::vector<int>;  // one per knob

// What is to be added to a run's number is no more than this: what all knobs leave together, or the root of the squares of what each does, as errors
// that cancel make no run better.
double estimate(const std::vector<Climb>& climbs, std::size_t quantity, const Levels& at);
bool settles(const std::vector<Climb>& climbs, std::size_t quantity, double goal);  // along all that leave a part of it worth it

// From `from` the levels at which the estimate is expected to be below `share` of every goal (absolute, one per quantity), within `most_cost`: always
// the knob that takes away most error per time (greedy.h), among those that leave a part of all that is worth it. No farther than tuning::kFarthest
// levels of a knob: what lies beyond is not like what was seen, and until it was other knobs wait. `reached` is false where none of these are fine
// enough.
struct Chosen {
  Levels levels;
  double cost = 1;  // expected, over that at level 0
  bool reached = false;
  std::size_t worst = 0;  // quantity
  std::size_t first = 0;  // the knob that was moved first
};
Chosen choose_levels(const std::vector<Climb>& climbs, const std::vector<double>& goals, double share, const Levels& from,
                     double most_cost = INFINITY);

}  // namespace mortise::study
