#pragma once
#include "run/options.h"
#include "run/routine.h"
#include "run/turn.h"

namespace mortise::run {

// Serves one run with an engine of its own until it ends; returns and throws what it does. Throws Error(Exit::device) where the device is missing or
// has too little memory.
Exit run_alone(const Options& options, Turn& turn, Routine<Exit>& run);

// One step of the engine that is asked for.
void take_step(Turn& turn);

}  // namespace mortise::run
