#pragma once
#include <string>
#include <vector>

#include "run/environment_end.h"

namespace mortise::run {

// How a batch of environments ended, by how each of them did.
struct BatchVerdict {
  Exit code = Exit::done;
  std::string message;  // of what failed
  long failed = 0, unfinished = 0;
};
// table: the path of the file that says why environments failed.
BatchVerdict verdict_of(const std::vector<EnvironmentEnd>& ends, const std::string& table);

}  // namespace mortise::run
