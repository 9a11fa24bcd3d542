#pragma once
// Which parts of a machine pass through each other.
#include <vector>

#include "importers/robot/machine.h"

namespace mortise::importers {

// Pairs of bodies and pads that are no neighbours and shall pass through each other: few joints lie between them, the file says so, or they lie in
// each other as they stand.
struct PassingPair {
  std::size_t a, b;
  enum class Why { near, said, overlap } why;
};
std::vector<PassingPair> passing_pairs(const Machine& machine, int apart);

}  // namespace mortise::importers
