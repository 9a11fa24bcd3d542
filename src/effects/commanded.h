#pragma once
// What an effect is beside an Effect whose targets can be given from outside while the simulation runs (src/bridge).
#include <vector>

#include "model/command.h"

namespace mortise::effects {

class Commanded {
 public:
  virtual ~Commanded() = default;
  // From the next step on, until others come; joints that are not named aim at what the scene says.
  virtual void command(const std::vector<model::Command>& commands) = 0;
};

}  // namespace mortise::effects
