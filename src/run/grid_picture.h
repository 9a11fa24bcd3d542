#pragma once
#include <string>
#include <vector>

namespace mortise::run {

struct Tile {
  std::string folder, label;  // where its pictures are; what stands in its corner
};

// One picture of every name that any tile's folder has, in the folder `to`: theirs side by side, row by row in the order of the tiles, made smaller
// so that all fit into the width of one. A folder that lacks it (an environment that ended early) leaves its place as it was last.
void draw_side_by_side(const std::vector<Tile>& tiles, const std::string& to);

}  // namespace mortise::run
