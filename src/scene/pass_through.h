#pragma once
// What nothing keeps apart: bodies that pass through each other, and why.
#include <string>
#include <vector>

#include "base/params.h"
#include "scene/scene.h"

namespace mortise::scene {

struct PassThrough {
  std::vector<std::string> bodies;  // two, or one that passes through itself
  std::string why;
  bool everything = false;   // no contact effect at all
  std::string text() const;  // "'a' and 'b' pass through each other: why"
};

// Every such pair in which something can move, in the scene's order. Of a scene without any contact effect one entry with all bodies.
std::vector<PassThrough> pass_through(const Params& scene, std::span<const EffectTable> effects);

// The entry of an effect's own list of pairs that names these two bodies; nullptr if it has no list or none names them.
const Params* listed_pair(const Params& effect, const std::string& a, const std::string& b);

}  // namespace mortise::scene
