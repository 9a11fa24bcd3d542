#include "scene/edge_lengths.h"

#include <algorithm>

namespace mortise::scene {
namespace {

void collect(const Params& block, const std::string& path, std::vector<EdgeLength>& out) {
  if (block.kind() == Params::Kind::list)
    for (std::size_t i = 0; i < block.items().size(); ++i) collect(block.items()[i], path + std::to_string(i) + ".", out);
  if (block.kind() != Params::Kind::table) return;
  for (const auto& [key, value] : block.entries()) {
    if (is_edge_length(key) && value.kind() == Params::Kind::number)
      out.push_back({path + key, value.as_number()});
    else
      collect(value, path + key + ".", out);
  }
}

}  // namespace

bool is_edge_length(const std::string& key) { return std::find(std::begin(kEdgeLengths), std::end(kEdgeLengths), key) != std::end(kEdgeLengths); }

std::vector<EdgeLength> edge_lengths(const Params& shape) {
  std::vector<EdgeLength> out;
  collect(shape, "", out);
  return out;
}

}  // namespace mortise::scene
