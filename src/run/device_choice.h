#pragma once
#include "engine/engine.h"
#include "run/record.h"

namespace mortise::run {

// The engine build that `--device` asks for: auto (CUDA where there is a GPU), cpu, cuda or cuda:N. Asking for CUDA where
// there is none is Error(Exit::device), never a silent CPU run. Notes in the record what was chosen.
const engine::Api& choose_device(const std::string& wanted, int threads, Record& record);

}  // namespace mortise::run
