#pragma once
// How near bodies are when a scene begins: the layer that a scene leaves open is no thicker than that, or it would push them apart.
#include <vector>

#include "model/input.h"

namespace mortise::effects::contact {

// The least distance from a vertex of one of `bodies` to a surface of another or to a half-space of the environment [m]; `upto` if none is nearer.
// Not looked at are pairs that the scene lets pass through each other or ties to each other, what is not on the effect's own list of pairs, and
// where edges are nearer to each other than any vertex.
double start_gap(const Params& effect, const model::ModelInput& input, const std::vector<const model::BodyInput*>& bodies, Index env, double upto);

}  // namespace mortise::effects::contact
