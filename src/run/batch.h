#pragma once
#include <span>

#include "base/error.h"
#include "run/options.h"
#include "scene/scene.h"

namespace mortise::run {

// `mortise run` of a scene with `environments`: each is a run of its own in DIR/env_0007, in a process of its own, so that nothing of one reaches
// another, not even a crash. Processes share out the CPU threads: one each where there are as many environments; on a GPU they run one after the
// other. What sums them up is written last: fields.vtkhdf, environments.csv, environments.json, run.json. Returns Exit::done or Exit::stopped; throws
// Error(Exit::solve) where an environment failed, when all others are done.
Exit run_batch(const Options& options, const scene::Scene& scene, std::span<const scene::EffectTable> tables);

}  // namespace mortise::run
