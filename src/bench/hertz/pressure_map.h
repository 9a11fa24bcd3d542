#pragma once
// Picture of the pressure on a face, drawn off-screen.
#include <string>

#include "bench/traction.h"

namespace mortise::bench {

struct PressureMap {
  std::string body;    // whose surface is shown: a quarter, mirrored at x = 0 and y = 0
  double radius = 1;   // a circle drawn on it, around the origin [m]; the picture shows 1.6 radii
  double highest = 1;  // end of the colours [Pa]
  std::string caption;
};

// Writes a PNG: the surface under the pressures `t` seen obliquely from above, where it is now. Throws Error(Exit::device) where there is no
// renderer, Error(Exit::file).
void write_pressure_map(const std::string& path, const PressureMap& map, const Solved& s, const Traction& t);

}  // namespace mortise::bench
