#pragma once
#include <string>

#include "base/params.h"

namespace mortise::importers {

// What `robot:` of a scene at `path` stands for (scene/robot.h). Meshes that have to be written anew go to the cache. Warnings go to the standard
// error, each once. Throws Error.
std::string scene_of_robot(const Params& block, const std::string& path);

}  // namespace mortise::importers
