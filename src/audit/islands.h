#pragma once
// Bodies that have touched or hang together, not over what goes as the scene says: between islands no energy goes to and fro, so what one of them has
// is no measure of what another loses.
#include <vector>

#include "audit/moving_body.h"
#include "base/archive.h"
#include "base/disjoint_sets.h"

namespace mortise::audit {

class Islands {
 public:
  void state(const std::vector<MovingBody>& bodies);
  // One body of the island that this one belongs to, the same for all of them; another one where islands have met since.
  std::size_t of(std::size_t body) { return sets_.of(body); }
  void checkpoint(Archive& archive);

 private:
  std::size_t bodies_ = 0;
  DisjointSets sets_{0};
};

}  // namespace mortise::audit
