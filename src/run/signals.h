#pragma once

namespace mortise::run {

// The first SIGTERM or SIGINT asks for a stop at the next Newton iteration; the second ends the process at once, with 128 + its number.
// SIGUSR1 asks for a checkpoint. Handlers only set flags.
void install_signal_handlers();
bool stop_asked();
bool checkpoint_asked();  // true once per SIGUSR1

}  // namespace mortise::run
