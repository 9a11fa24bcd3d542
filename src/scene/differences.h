#pragma once
#include <string>
#include <vector>

namespace mortise::scene {

// Where two scenes in YAML differ, in the order of the second, one line each: "time.steps is 60 there and 80 here". there, here: resolved scenes
// (to_yaml). Throws Error(Exit::file) where one is none.
std::vector<std::string> differences(const std::string& there, const std::string& here);

}  // namespace mortise::scene
