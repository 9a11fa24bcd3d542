#pragma once
// How fast this machine is, by a small scene that is run once and kept in the cache folder as speed.json.
#include <string>

namespace mortise::cost {

struct Speed {
  double slowness = 1;  // CPU time of the small scene over that on the machine of the model's numbers
  double load = 0;      // load average meanwhile
  std::string date;     // when it was run
  bool now = false;     // just now
};

// Runs it where it was not yet, or with another processor or version: about a second of CPU time, on one thread. Throws Error where it cannot be run.
Speed speed_of_machine();

}  // namespace mortise::cost
