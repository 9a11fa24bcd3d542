#pragma once
#include <cstddef>

#include "model/input.h"

namespace mortise::engine {

// Device memory [B] that a run will hold at most, from the sizes of its meshes: elements and their matrix with conjugate gradients,
// and the search for contact. Measured peaks (memory_needed.cpp) lie within 10 % of it. Contact that covers much of a surface needs
// more, and so does the factor of a direct solver (host memory on a CPU).
std::size_t memory_needed(const model::ModelInput& input);

}  // namespace mortise::engine
