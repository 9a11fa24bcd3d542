#pragma once
// Which device the engine runs on. The choice holds for the process: runs, benchmarks and tests ask for chosen().
#include <string>

#include "engine/api.h"

namespace mortise::engine {

// What `--device` takes.
inline constexpr const char* kDeviceHelp =
    "auto, cpu, cuda, cuda:N (the N-th GPU, from 0) or debug (the CPU with GPU memory rules enforced); cuda without a GPU is an error (exit 4)";

struct Choice {
  const Api* api;
  device::DeviceInfo device;
};

// auto: the first GPU where there is one, else the CPU. Asking for CUDA where there is none is Error(Exit::device), never a
// silent CPU run; a name that is no device is Error(Exit::usage). `threads`: CPU threads, 0 = what the machine grants.
Choice choose(const std::string& wanted, int threads = 0);

bool is_device_name(const std::string& name);

// The last choice; the CPU before the first.
const Choice& chosen();

}  // namespace mortise::engine
