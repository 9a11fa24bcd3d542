#pragma once
// Joints that close a loop and hold nothing that others do not hold already, as a door's second hinge: how stiff bodies share what they bear is not
// determined, the first bears all (model/ties.h), and what is reported of the others is zero. x = p + A X of bodies that nothing holds; a joint at c
// says, in the scalars of (p, a1, a2, a3),
//
//     (1, c) of both alike      place: of balls, hinges, fixed joints
//     (0, u) of both alike      direction: of hinges their axis; of fixed joints and slides all three,
//
// and is idle where all of that is a combination of what others say.
#include <string>
#include <vector>

#include "model/input.h"

namespace mortise::run {

// What is to be said of every such joint, with its place in the scene.
std::vector<std::string> idle_joints(const model::ModelInput& input);

}  // namespace mortise::run
