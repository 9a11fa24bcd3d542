#include <sys/resource.h>
#include <unistd.h>

#include "cli/commands.h"

namespace {

// Runs before the libraries start: OpenBLAS takes 128 MiB of addresses a thread then, and asks again for ever where it gets none.
void check_address_space(int, char**, char**) {
  constexpr rlim_t kLeast = rlim_t{1} << 30;
  rlimit limit = {};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur >= kLeast) return;
  constexpr char kMessage[] = "error: the limit on address space (ulimit -v) is below the 1048576 KiB that mortise needs at least\n";
  (void)!write(STDERR_FILENO, kMessage, sizeof kMessage - 1);
  _exit(4);  // Exit::device
}
[[gnu::section(".preinit_array"), gnu::used]] void (*const kFirst)(int, char**, char**) = check_address_space;

}  // namespace

int main(int argc, char** argv) { return mortise::cli::program({argv + 1, argv + argc}); }
