#pragma once
// Which bodies nothing holds or leads, and which of all bodies touch something.
#include <vector>

#include "base/snapshot.h"
#include "model/input.h"
#include "run/measured_body.h"

namespace mortise::run {

class FreeBodies {
 public:
  explicit FreeBodies(const model::ModelInput& input);
  bool free(std::size_t body) const { return free_[body] != 0; }

 private:
  std::vector<char> free_;  // without half-spaces
};

// Is a force of contact on any of its points? contact_force of all points [N], three each.
bool touches(const MeasuredBody& body, const Snapshot::Values& contact_force);

}  // namespace mortise::run
