#pragma once
#include <cmath>
#include <nlohmann/json.hpp>

namespace mortise::output {

/// A number for JSON, which has neither infinities nor NaN: null stands for them.
inline nlohmann::ordered_json number_or_null(double v) { return std::isfinite(v) ? nlohmann::ordered_json(v) : nlohmann::ordered_json(nullptr); }

}  // namespace mortise::output
