#pragma once
// What the emulated device says about a run: faults, at once and on stderr; and at the end of the process, appended as one line of JSON to
// the file named by MORTISE_PTX_REPORT, which kernels there are, how often and how many threads of them ran, and which runtime functions were called
// how often (of a process that was forked, in a file of its own with its number behind the name). A process with faults ends with exit code 70.
#include <cstddef>
#include <string>

#include "machine.h"

namespace ptx {

struct Settings {
  bool backwards;      // MORTISE_PTX_ORDER=backwards: the last thread of a launch runs first
  std::size_t memory;  // MORTISE_PTX_MEMORY_MIB, 8192 without it
  std::string fail;    // MORTISE_PTX_FAIL=FUNCTION:N:ERROR[,...]: the N-th call of a runtime function returns this cudaError_t
};
const Settings& settings();

// Counted under `fault` (its kind and place), printed once with the details.
void report(const std::string& fault, const std::string& details = "");
std::size_t faults();
void count_call(const char* function);
// Bytes of device memory: of all accesses, and of what they touched at least once in a launch (checked mode only).
struct Traffic {
  std::size_t accessed = 0, touched = 0;
};
void count_run(const Kernel*, std::size_t threads, const Traffic&);
void count_known(const Kernel*);
std::string readable(const Kernel*);  // its name as C++
void count_wait();                    // the host waits for the device

}  // namespace ptx
