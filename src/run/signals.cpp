#include "run/signals.h"

#include <unistd.h>

#include <csignal>
#include <initializer_list>
#include <utility>

namespace mortise::run {
namespace {

volatile std::sig_atomic_t stop = 0, checkpoint = 0;

extern "C" void on_signal(int signal) {
  if (signal == SIGUSR1) {
    checkpoint = checkpoint + 1;
    return;
  }
  if (stop) _exit(128 + signal);  // the second one ends the program, wherever it hangs
  stop = 1;
}

}  // namespace

void install_signal_handlers() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  for (int s : {SIGINT, SIGTERM, SIGUSR1}) sigaction(s, &action, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);  // a file-size limit then shows as a failed write, with a message
}

bool stop_asked() { return stop != 0; }

int checkpoints_asked() { return checkpoint; }

bool checkpoint_asked(int& seen) { return std::exchange(seen, static_cast<int>(checkpoint)) != checkpoint; }

}  // namespace mortise::run
