#pragma once
#include "engine/api.h"

namespace mortise::engine {

// Times y = A x for the matrix of a cube of edge^3 nodes that are coupled with their 26 neighbours, and copies of as many bytes.
void measure_bandwidth(Index edge, Bandwidth& out);

}  // namespace mortise::engine
