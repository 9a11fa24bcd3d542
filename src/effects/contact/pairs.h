#pragma once
// Which bodies a contact effect keeps apart.
#include <cstdint>
#include <vector>

#include "base/params.h"
#include "model/model.h"

namespace mortise::effects::contact {

// contact: forces act between the two, and neither passes through the other. apart: both go where supports say, so that no force could move
// them; the step in which they would meet fails (prescribed.h).
enum class Watch : std::uint8_t { no = 0, contact = 1, apart = 2 };

struct WatchedPairs {
  Index n = 0;                // bodies
  std::vector<Watch> bodies;  // bodies x bodies, symmetric
  std::vector<Watch> planes;  // half-spaces x bodies
  explicit WatchedPairs(const model::Model& model)
      : n(static_cast<Index>(model.bodies.size())), bodies(n * n, Watch::no), planes(model.half_spaces.size() * n, Watch::no) {}
  // a: a body; b: a body, or the number of bodies plus the index of a half-space.
  void set(Index a, Index b, Watch how) {
    if (b >= n)
      planes[(b - n) * n + a] = how;
    else
      bodies[a * n + b] = bodies[b * n + a] = how;
  }
};

// The pairs named by `list` (a list of [a, b] names, bodies or half-spaces; nullptr: all pairs of different bodies), completed. Call when all
// supports are set. Throws Error(Exit::scene) for names that do not exist.
WatchedPairs watched_pairs(const model::Model& model, const Params* list);

// What holds whatever pairs an effect names: soft bodies meet themselves unless they say `self_contact: false`; prescribed bodies are kept apart
// from each other and from half-spaces, unless they move as one; and the scene's `pairs` with `collide: false` pass through each other, as bodies
// do that are tied to each other.
void complete(const model::Model& model, WatchedPairs& pairs);

}  // namespace mortise::effects::contact
