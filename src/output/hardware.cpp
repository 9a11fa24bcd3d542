#include "output/hardware.h"

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

#include "base/shell.h"

namespace mortise::output {

Hardware hardware() {
  Hardware h{"unknown", 1, 0};
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.starts_with("model name")) {
      const auto colon = line.find(": ");
      if (colon != std::string::npos) h.cpu = line.substr(colon + 2);
      break;
    }
  }
  cpu_set_t mine;
  if (::sched_getaffinity(0, sizeof mine, &mine) == 0) h.cores = CPU_COUNT(&mine);
  h.memory_bytes = static_cast<std::int64_t>(::sysconf(_SC_PHYS_PAGES)) * ::sysconf(_SC_PAGESIZE);
  return h;
}

std::string command_line() {
  std::ifstream arguments("/proc/self/cmdline", std::ios::binary);
  std::string text;
  for (std::string one; std::getline(arguments, one, '\0');) text += (text.empty() ? "" : " ") + shell_word(one);
  return text;
}

std::int64_t peak_memory_bytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::int64_t>(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

}  // namespace mortise::output
