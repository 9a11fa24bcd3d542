#pragma once
// Bodies that have touched or hang together, not over what goes as the scene says: between islands no energy goes to and fro, so what one of them has
// is no measure of what another loses.
#include <vector>

#include "audit/moving_body.h"
#include "base/archive.h"

namespace mortise::audit {

class Islands {
 public:
  void state(const std::vector<MovingBody>& bodies);
  // The least number of a body of the island that this one belongs to; less than it was where islands have met since.
  std::size_t of(std::size_t body) const { return static_cast<std::size_t>(of_[body]); }
  void checkpoint(Archive& archive) { archive.io("islands", of_); }

 private:
  std::vector<double> of_;  // of every body
};

}  // namespace mortise::audit
