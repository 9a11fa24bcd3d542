#pragma once

namespace mortise::run {

// The first SIGTERM or SIGINT asks for a stop at the next Newton iteration; the second ends the process at once, with 128 + its number.
// SIGUSR1 asks for a checkpoint. Handlers only set flags.
void install_signal_handlers();
void install_checkpoint_handler();  // of SIGUSR1 alone, which asks in vain while there is nothing to save, and must not end the program
bool stop_asked();
int checkpoints_asked();           // how often so far
bool checkpoint_asked(int& seen);  // again since they were `seen`

}  // namespace mortise::run
