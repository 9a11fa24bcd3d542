#pragma once
#include <cstdint>
#include <string>

namespace mortise::output {

// The machine a run was on.
struct Hardware {
  std::string cpu;                // model name; "unknown" where the system does not tell
  int cores = 0;                  // that this process may use (affinity mask)
  std::int64_t memory_bytes = 0;  // main memory
};

Hardware hardware();

// How this process was started: its arguments as a shell would take them.
std::string command_line();

// Largest resident memory of this process so far [bytes].
std::int64_t peak_memory_bytes();

}  // namespace mortise::output
