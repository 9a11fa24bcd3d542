#pragma once
// Entries of (slave node, block) that many parts add to (averaged.h).
#include <cstdint>

#include "effects/mortar_contact/view.h"

namespace mortise::effects::mortar {

MORTISE_HD inline std::uint64_t entry_key(Index high, Index low) { return static_cast<std::uint64_t>(high) << 32 | static_cast<std::uint64_t>(low); }
MORTISE_HD inline Index high(std::uint64_t key) { return static_cast<Index>(key >> 32); }

// Brought in order, entry e is the sum of those at order[start[e]] ... order[start[e + 1] - 1]; those of a node begin at offset[node].
void merge(Buffer<std::uint64_t>& keys, Index nodes, Buffer<Index>& order, Buffer<Index>& start, Buffer<Index>& offset, Buffer<Index>& block);

}  // namespace mortise::effects::mortar
