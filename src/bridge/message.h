#pragma once
// What a partner says: one line of JSON.
#include <map>
#include <string>
#include <vector>

#include "base/params.h"

namespace mortise::bridge {

// A drive of the scene, as a partner may command it.
struct Drive {
  enum class Mode { pd, kinematic, effort };
  std::string joint;
  Mode mode = Mode::pd;
  bool slides = false;
  double low, high;  // limits of the joint, infinite where it has none [rad, m]
  const char* mode_name() const { return mode == Mode::pd ? "pd" : mode == Mode::kinematic ? "kinematic" : "effort"; }
  const char* unit() const { return mode == Mode::effort ? (slides ? "N" : "N m") : slides ? "m" : "rad"; }
};

// All that are not passive, in the order of the scene.
std::vector<Drive> drives_of(const Params& scene);

struct Message {
  std::map<std::string, double> values;  // by joint: target [rad, m] or effort [N m, N], as the drive's mode takes it
  bool reset = false, end = false;
};

// `from`: what the message is called in errors, "message 3, the answer to step 8". Throws Error(kPartnerFailed) where the line is not exactly what
// README.md says.
Message read_message(const std::string& line, const std::string& from, const std::vector<Drive>& drives);

}  // namespace mortise::bridge
