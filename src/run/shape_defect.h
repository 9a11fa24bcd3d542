#pragma once
// Flat facets leave out a part of a round body: of a sphere, cylinder or capsule the share 1 - V / V_exact of its volume, so of its weight; of the
// stiffness of a bar against bending and twisting about twice that.
#include "model/input.h"

namespace mortise::run {

// The largest of all bodies whose volume bears on a result: soft ones, and stiff ones that nothing holds and whose mass the scene does not state; 0
// where there is no round one. Of curved elements nothing is left out.
double shape_defect(const model::ModelInput& input);

}  // namespace mortise::run
