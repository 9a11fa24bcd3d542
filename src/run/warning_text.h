#pragma once
// What warnings about a scene have in common.
#include <cmath>
#include <numbers>
#include <string>

#include "base/error.h"

namespace mortise::run {

inline std::string at(const SourceLoc& where, const std::string& text) { return where.file.empty() ? text : where.text() + ": " + text; }

// A number without a unit is in radians; some mean degrees.
inline bool more_than_a_turn(double angle) { return std::abs(angle) > 2 * std::numbers::pi * (1 + 1e-6); }

}  // namespace mortise::run
