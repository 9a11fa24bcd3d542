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

void handle(std::initializer_list<int> signals) {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  for (int s : signals) sigaction(s, &action, nullptr);
}

}  // namespace

void install_checkpoint_handler() { handle({SIGUSR1}); }

void install_signal_handlers() {
  handle({SIGINT, SIGTERM, SIGUSR1});
  std::signal(SIGXFSZ, SIG_IGN);  // a file-size limit then shows as a failed write, with a message
}

bool stop_asked() { return stop != 0; }

int checkpoints_asked() { return checkpoint; }

bool checkpoint_asked(int& seen) { return std::exchange(seen, static_cast<int>(checkpoint)) != checkpoint; }

}  // namespace mortise::run
