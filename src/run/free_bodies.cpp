#include "run/free_bodies.h"

#include <algorithm>

#include "run/holds.h"

namespace mortise::run {

FreeBodies::FreeBodies(const model::ModelInput& input) {
  const Holds holds(input.scene.at("effects"));
  const auto& pairs = holds.together();
  for (const model::BodyInput& b : input.bodies)
    if (b.type != model::BodyType::half_space)
      free_.push_back(!holds.held(b.name) &&
                      std::none_of(pairs.begin(), pairs.end(), [&](const auto& p) { return p.first == b.name || p.second == b.name; }));
}

bool touches(const MeasuredBody& body, const Snapshot::Values& contact_force) {
  const auto begin = contact_force.begin() + static_cast<std::ptrdiff_t>(3 * body.first);
  return std::any_of(begin, begin + static_cast<std::ptrdiff_t>(3 * body.count), [](double f) { return f != 0; });
}

}  // namespace mortise::run
