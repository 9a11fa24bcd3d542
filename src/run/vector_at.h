#pragma once
#include <span>

#include "base/types.h"

namespace mortise::run {

// The i-th vector of a field of vectors.
inline Vec3 at(std::span<const double> v, std::size_t i) { return {v[3 * i], v[3 * i + 1], v[3 * i + 2]}; }

}  // namespace mortise::run
