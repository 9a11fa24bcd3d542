#include "audit/islands.h"

#include <algorithm>
#include <numeric>

namespace mortise::audit {

void Islands::state(const std::vector<MovingBody>& bodies) {
  if (of_.empty()) of_.resize(bodies.size()), std::iota(of_.begin(), of_.end(), 0.0);
  const auto join = [this](std::size_t a, std::size_t b) {
    const auto [one, other] = std::minmax({of_[a], of_[b]});
    if (one < other) std::replace(of_.begin(), of_.end(), other, one);
  };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    if (b.given) continue;
    join(i, b.group);
    if (b.on && !bodies[*b.on].given) join(i, *b.on);
  }
}

}  // namespace mortise::audit
