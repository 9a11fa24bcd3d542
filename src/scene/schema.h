#pragma once
#include <span>
#include <string>

#include "scene/scene.h"

namespace mortise::scene {

// JSON Schema (draft-07) of scene files, generated from the tables; ends with a newline. Editors check and complete by it.
std::string schema(std::span<const EffectTable> effects);

}  // namespace mortise::scene
