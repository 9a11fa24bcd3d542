#pragma once
#include "engine/engine.h"

namespace mortise::run {

// The engine build that `--device` asks for: auto (CUDA where there is a GPU), cpu or cuda. Asking for CUDA where
// there is none is Error(Exit::device), never a silent CPU run. `chosen` tells what it runs on.
const engine::Api& choose_device(const std::string& wanted, int threads, device::DeviceInfo& chosen);

}  // namespace mortise::run
