#pragma once
// Which bodies a contact effect keeps apart.
#include "base/params.h"
#include "effects/contact/proximity.h"

namespace mortise::effects::contact {

// The pairs named by `list` (a list of [a, b] names, bodies or half-spaces; nullptr: all pairs of different bodies, and those
// bodies with themselves that ask for self_contact), less the pairs in which nothing can move. Call when all supports are set.
// Throws Error(Exit::scene) for names that do not exist.
WatchedPairs watched_pairs(const model::Model& model, const Params* list);

}  // namespace mortise::effects::contact
