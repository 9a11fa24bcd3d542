#pragma once
// In motion, drives and loads go by the clock of the time step: of s(t), what a schedule or a sine says, the solver sees s at the ends of steps. What
// lies between them,
//
//     missed = int |s - L| dt / int |s - s(0)| dt,     L: straight from the end of a step to that of the next,
//
// is a pulse that falls into one step, or a sine with few steps in a period: 3 % of one with ten. Gaits are not looked at: they are smooth, and slow.
// What pins do within a step is checked in every step (effects/pin).
// Of forces and torques what they leave in motion counts, too: a step goes by what they are at its end, so that one that sets in or breaks off within
// it is a part of a step too long or too short for good. Where it is nothing, and in the end,
//
//     missed = 2 |sum h s(t_n) - int s dt| / max |int s dt|
//
// (twice, as ways and heights go by the square), in which smooth changes, no jumps, count in the middle of their steps: motion_lag tells of these.
// Without motion only the way counts by which the end is reached, where there is friction. With S(t) all that pins, drives and loads say, each over
// what it goes through in all,
//
//     missed = 1 - sum over the steps of |S(t_n+1) - S(t_n)| / length of the way of S,
//
// is a force that rises and falls within a load step, or a press and a slide that become one slanting push. And where quantities look at more than
// the end, as at what is largest over time: what part of the range of s no load step ends with.
#include "model/input.h"

namespace mortise::audit {

// In motion the largest of all drives and loads; NaN where nothing changes.
double schedule_missed(const model::ModelInput& input);

}  // namespace mortise::audit
