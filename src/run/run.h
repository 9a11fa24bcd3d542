#pragma once
#include "base/error.h"
#include "run/options.h"
#include "run/progress.h"
#include "run/routine.h"
#include "run/turn.h"
#include "scene/scene.h"

namespace mortise::bridge {
struct Options;
}

namespace mortise::run {

// `mortise run`: scene -> fields.vtkhdf, checkpoint.h5, frames/*.png, run.json in the output folder. Returns Exit::done or
// Exit::stopped; throws Error. `tables`: the effects that scenes may name. Whatever happens, finished frames (after a kill: those that the last
// checkpoint counts) and the last checkpoint stay readable. A scene with `environments` has a folder of this kind for each of them (batch.h).
Exit run_scene(const Options& options, std::span<const scene::EffectTable> tables);

// The same of a scene that has been read and is one run; it waits at `turn`. `ended_by`: the condition of options.resets that ended it, if one did.
// `bridge`: who drives it, if somebody does. What is referred to has to outlive it.
Routine<Exit> run_one(const Options& options, scene::Scene scene, Progress& progress, Turn& turn, std::string* ended_by = nullptr,
                      const bridge::Options* bridge = nullptr);

}  // namespace mortise::run
