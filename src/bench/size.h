#pragma once
// Sizes of the meshes by name, as benchmarks of one contact spot offer them.
#include <algorithm>
#include <span>

#include "base/error.h"
#include "bench/meshes.h"

namespace mortise::bench {

struct Size {
  const char* name;
  Spot mesh;
  double d_hat;  // [m]
  double l2;     // gate of the pressure's L2 error
};

// Throws Error(Exit::usage) with the names that there are.
inline const Size& size_of(std::span<const Size> sizes, const std::string& name) {
  const auto it = std::find_if(sizes.begin(), sizes.end(), [&](const Size& s) { return s.name == name; });
  if (it != sizes.end()) return *it;
  std::string known;
  for (const Size& s : sizes) known += (known.empty() ? "" : ", ") + std::string(s.name);
  throw Error(Exit::usage, "--set size: no '" + name + "'; there are " + known);
}

}  // namespace mortise::bench
