#pragma once
#include <span>

#include "run/options.h"
#include "run/progress.h"
#include "scene/scene.h"

namespace mortise::run {

// Throws Error(Exit::usage) where a bridge that is asked for cannot drive the scene.
void check_bridge(const Options& options, const scene::Scene& scene);

// Is the run driven from outside: by a partner, by a recording, or by what its folder recorded before it was stopped?
bool is_bridged(const Options& options, const scene::Scene& scene);

// A run that is driven, one environment of a scene that has several, and after every reset that it asks for another one: from the start, with numbers
// of its own where the scene has `environments`, in the folder episode_0001, ... of the first one's. Returns and throws as run_one() of the last.
Exit run_bridged(const Options& options, const scene::Scene& scene, std::span<const scene::EffectTable> tables, Progress& progress);

}  // namespace mortise::run
