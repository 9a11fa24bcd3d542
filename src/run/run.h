#pragma once
#include "base/error.h"
#include "run/options.h"
#include "scene/scene.h"

namespace mortise::run {

// The effects of this program as the scene reader wants them.
std::vector<scene::EffectTable> effect_tables();

// `mortise run`: scene -> fields.vtkhdf, checkpoint.h5, frames/*.png, run.json in the output folder. Returns Exit::done or
// Exit::stopped; throws Error. Whatever happens, finished frames and the last checkpoint stay readable.
Exit run_scene(const Options& options);

}  // namespace mortise::run
