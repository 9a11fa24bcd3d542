#include <fcntl.h>
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <limits>

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

// Every iteration asks for the same large pieces again. Given back to the system they would be had page by page each time: three page faults of four
// and more than half of the system's time in the dragged press (0.7 of 17.4 CPU s). Kept, they cost 4 to 7 % of memory. One arena, because those of
// threads are given back whatever one says.
void keep_memory() {
#ifdef __GLIBC__
  mallopt(M_ARENA_MAX, 1);
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
#endif
}

// A launcher may start programs without standard streams. The next files that are opened would be taken for them, and what is printed would go there.
void open_standard_streams() {
  for (int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0) (void)!open("/dev/null", stream == STDIN_FILENO ? O_RDONLY : O_WRONLY);
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();
  keep_memory();
  return mortise::cli::program({argv + 1, argv + argc});
}
