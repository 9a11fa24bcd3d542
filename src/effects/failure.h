#pragma once
#include <string>

#include "base/types.h"

namespace mortise::effects {

// A step of an environment that did not converge, or that cannot be taken: why, where and with which figures. A shorter step may still be.
struct Failure {
  std::string reason;
  Index env = 0;
};

}  // namespace mortise::effects
