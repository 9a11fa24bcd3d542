#pragma once
// Blocks of a scene, written in C++.
#include <string>
#include <utility>
#include <vector>

#include "base/params.h"

namespace mortise::testing {

inline Params table(const std::vector<std::pair<std::string, Params>>& entries) {
  Params out = Params::make_table();
  for (const auto& [key, value] : entries) out.set(key, value);
  return out;
}
inline Params number(double v) { return Params::make_number(v); }

}  // namespace mortise::testing
