#pragma once
#include <string>
#include <vector>

namespace mortise::run {

// One picture of every name that any of `folders` has, in the folder `to`: theirs side by side, row by row in the order of the folders, made smaller
// so that all fit into the width of one. A folder that lacks it (an environment that ended early) leaves its place as it was last.
void draw_side_by_side(const std::vector<std::string>& folders, const std::string& to);

}  // namespace mortise::run
