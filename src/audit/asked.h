#pragma once
// What the schedules of a scene ask for over time: pins, drives and loads. Gaits are left out: they are smooth.
#include <functional>
#include <vector>

#include "model/input.h"

namespace mortise::audit {

struct Asked {
  std::function<double(double)> at;  // a number each: a component of a translation, an angle, a component of a quaternion, a target, a load
  std::vector<double> keys;          // where it may bend [s]
  bool pushes = false;               // a force, a torque or a load, whose integral over time sets something in motion
};

std::vector<Asked> asked_of_drives_and_loads(const Params& effects);
std::vector<Asked> all_asked(const Params& effects);

// Times after the start, ascending, at which one phase of a scene ends and another begins: keys of pins, drives and loads, but of schedules that have
// so many that they draw a curve.
struct Phase {
  double end;  // [s]
  bool moves;  // something is asked for at its end that was not at its start
};
std::vector<Phase> phases(const Params& effects);

}  // namespace mortise::audit
