#pragma once
// Where a material averages changes of volume (src/effects/elasticity/README.md): which tetrahedra of a body share a mean.
#include <vector>

#include "judge/case.h"

namespace judge {

// Of every tetrahedron.
std::vector<long> volume_groups(const Body& body);

}  // namespace judge
