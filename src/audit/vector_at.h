#pragma once
#include <span>

#include "base/snapshot.h"
#include "base/types.h"

namespace mortise::audit {

// The i-th vector of a field of vectors.
inline Vec3 at(std::span<const double> v, std::size_t i) { return {v[3 * i], v[3 * i + 1], v[3 * i + 2]}; }

// Values of points; empty where nobody reported them.
inline std::span<const double> of_points(const Snapshot& said, const char* name, int components) {
  const Snapshot::Values* v = said.of_points(name, components);
  return v ? std::span<const double>(*v) : std::span<const double>();
}

}  // namespace mortise::audit
