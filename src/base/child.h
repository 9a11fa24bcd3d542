#pragma once
#include <functional>
#include <string>

#include "base/error.h"

namespace mortise {

struct ChildLimits {
  unsigned seconds;
  std::size_t bytes;  // of memory, beyond what this process has
};

// Runs `job` in a copy of this process and returns what it returns: for code that does not stand damaged input. If it crashes or goes beyond a limit,
// `blame` is thrown with `what` ("'a.glb' cannot be read") and the reason; an Error that the job throws is thrown here, without its place in the
// text. What it prints is lost, and it can change nothing (cage.h).
std::string in_child(const std::string& what, ChildLimits limits, const std::function<std::string()>& job, Exit blame = Exit::scene);

}  // namespace mortise
