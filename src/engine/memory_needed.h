#pragma once
#include <cstddef>

#include "model/input.h"

namespace mortise::engine {

// Device memory [B] that a run will hold at most, from the sizes of its meshes: elements and their matrix with conjugate gradients and
// the preconditioner that may be chosen, and the search for contact. At most half as much again as what is held then (a test compares).
// Contact that covers much of a surface needs more, and so does the factor of a direct solver (host memory on a CPU).
std::size_t memory_needed(const model::ModelInput& input);

}  // namespace mortise::engine
