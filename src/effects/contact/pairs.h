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
  const geometry::BodyPairs& of;
  std::vector<Watch> how;  // per pair of bodies of one environment, symmetric, and of half-spaces
  explicit WatchedPairs(const model::Model& model) : of(model.surface.pairs), how(of.size(model.half_spaces.size()), Watch::no) {}
  // a: a body; b: a body of its environment, or the number of bodies plus the index of a half-space.
  void set(Index a, Index b, Watch to) {
    how[of.of(a, b)] = to;
    if (b < of.bodies()) how[of.of(b, a)] = to;
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
