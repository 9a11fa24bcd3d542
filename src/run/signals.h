#pragma once

namespace mortise::run {

// SIGTERM and the first SIGINT ask for a stop at the next Newton iteration; a second SIGINT ends the process at once with 130.
// SIGUSR1 asks for a checkpoint. Handlers only set flags.
void install_signal_handlers();
bool stop_asked();
bool checkpoint_asked();  // true once per SIGUSR1

}  // namespace mortise::run
