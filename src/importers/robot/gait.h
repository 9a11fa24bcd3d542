#pragma once
#include "importers/robot/machine.h"

namespace mortise::importers {

// Lets the four legs of a machine step in turn, each by its two last hinges (effects/drive/gait.h): forward is x, steps are as long as suits the legs
// where `options` do not say. Throws Error(Exit::usage) where these are no four legs, two before two.
void walk(Machine& machine, const GaitOptions& options);

}  // namespace mortise::importers
