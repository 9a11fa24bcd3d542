#pragma once
#include <ctime>

namespace mortise {

// CPU time of this process so far, user and system, of all threads [s].
inline double cpu_time() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace mortise
