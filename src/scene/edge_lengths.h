#pragma once
// The keys of a body's `shape` that say how fine its mesh is.
#include <string>
#include <vector>

#include "base/params.h"

namespace mortise::scene {

inline constexpr const char* kEdgeLengths[] = {"edge_length", "surface_edge_length"};
bool is_edge_length(const std::string& key);

// Those that are given as numbers, in a shape and in its parts.
struct EdgeLength {
  std::string path;  // "box.edge_length", "parts.0.shape.sphere.edge_length"
  double length;     // [m]
};
std::vector<EdgeLength> edge_lengths(const Params& shape);

}  // namespace mortise::scene
