#pragma once
// Drives and loads go by the clock of the time step: of s(t), what a schedule or a sine says, the solver sees s at the ends of steps. What lies
// between them,
//
//     missed = int |s - L| dt / int |s - s(0)| dt,     L: straight from the end of a step to that of the next,
//
// is a pulse that falls into one step, or a sine with few steps in a period: 3 % of one with ten. Gaits are not looked at: they are smooth, and slow.
// What pins do within a step is checked in every step (effects/pin).
#include "model/input.h"

namespace mortise::run {

// The largest of all drives and loads of a scene in motion; NaN where there is none that changes.
double schedule_missed(const model::ModelInput& input);

}  // namespace mortise::run
