#pragma once
// Which runs a study is made of.
#include <cstddef>
#include <string>
#include <vector>

#include "study/study.h"
#include "study/variant.h"

namespace mortise::study {

struct Planned {
  std::size_t method = 0;
  Settings settings;
  std::string label;  // "time.step=2 ms"
  Variant variant{};  // of a scene's
};

// Runs along one ladder, all else equal.
struct Curve {
  std::string name;
  std::size_t method = 0, ladder = 0;
  std::vector<std::size_t> runs;  // one per step of the ladder
};

struct OnCurve {
  std::size_t curve, step;
};

// A run with several knobs moved, by steps of these curves.
struct Together {
  std::size_t run;
  std::vector<OnCurve> steps;
};

struct Plan {
  std::vector<Planned> runs;
  std::vector<Curve> curves;
  std::vector<std::size_t> base;    // one knob at a time: per method the run of the scene as it is
  std::vector<Together> refined{};  // in the order in which they were tried; the first tells how knobs interact
};

// Throws Error(Exit::usage) for studies that make no sense. The scene of every run is made before the first one runs: wrong settings are told with
// the place of the ladder that they stand in.
Plan plan_of(const Study& study);

// The settings of the over-resolved run, if they are fine enough; throws Error(Exit::usage) where they are not.
Settings over_resolved(const Study& study);

std::string label_of(const Settings& settings);                          // "time.step=2 ms, a.b=1"
std::string step_label(const Ladder& ladder, const Ladder::Step& step);  // "mesh 2 mm" of a ladder with a name of its own, else "time.step=2 ms"

}  // namespace mortise::study
