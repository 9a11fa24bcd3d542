#pragma once
// From an entry of environments.vary to numbers.
#include <map>
#include <string>

#include "base/params.h"

namespace mortise::scene {

inline constexpr const char* kWays[] = {"scale", "add", "abs"};  // of using what is drawn

// The one of them that an entry has, with its name; null where it has none or several.
const Params* way_of(const Params& entry, std::string& name);

double combined(const std::string& way, double base, double drawn);

// `distribution` as written, at u in (0, 1).
double drawn_from(const Params& distribution, double u);

// u of one draw.
double chance(const Params& environments, const std::string& path, long environment, long episode);

}  // namespace mortise::scene
