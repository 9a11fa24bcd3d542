#pragma once
#include <vector>

#include "scene/scene.h"

namespace mortise::engine {

// The effects that scenes may name, as the scene reader wants them: what effects::list() offers.
std::vector<scene::EffectTable> effect_tables();

}  // namespace mortise::engine
