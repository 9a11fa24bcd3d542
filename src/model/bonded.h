#pragma once
#include <vector>

#include "model/input.h"

namespace mortise::model {

// Nodes of a soft body that an entry of the effect `bond` ties to a stiff one: those that its `where` selects, of them those inside the stiff body or
// `within` that distance of its surface. Throws Error(Exit::scene) where there is none.
std::vector<Index> bonded(const Params& bond, const BodyInput& soft, const BodyInput& stiff);

}  // namespace mortise::model
