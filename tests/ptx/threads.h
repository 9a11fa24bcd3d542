#pragma once
// Runs the threads of a launch on the CPU, one after the other.
#include <cstdint>
#include <vector>

#include "machine.h"

namespace ptx {

struct Launch {
  const Kernel* kernel;
  std::uint32_t grid[3], block[3];
  std::uint32_t dynamic_shared;
  std::vector<std::uint8_t> parameters;
};
void run(Launch& launch);

}  // namespace ptx
