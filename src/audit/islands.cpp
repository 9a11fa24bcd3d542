#include "audit/islands.h"

namespace mortise::audit {

void Islands::state(const std::vector<MovingBody>& bodies) {
  if (bodies_ == 0) bodies_ = bodies.size(), sets_ = DisjointSets(bodies_);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MovingBody& b = bodies[i];
    if (b.given) continue;
    sets_.join(i, b.group);
    if (b.on && !bodies[*b.on].given) sets_.join(i, *b.on);
  }
}

void Islands::checkpoint(Archive& archive) {
  std::vector<double> of;
  for (std::size_t i = 0; i < bodies_; ++i) of.push_back(static_cast<double>(sets_.of(i)));
  archive.io("islands", of);
  if (!archive.loading()) return;
  bodies_ = of.size(), sets_ = DisjointSets(bodies_);
  for (std::size_t i = 0; i < bodies_; ++i) sets_.join(i, static_cast<std::size_t>(of[i]));
}

}  // namespace mortise::audit
