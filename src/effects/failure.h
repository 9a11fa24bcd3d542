#pragma once
#include <string>

namespace mortise::effects {

// A step that did not converge, or that cannot be taken: why, where and with which figures. A shorter step may still be.
struct Failure {
  std::string reason;
};

}  // namespace mortise::effects
