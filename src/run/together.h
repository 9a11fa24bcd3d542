#pragma once
#include <functional>
#include <span>

#include "run/environment_end.h"
#include "run/options.h"
#include "run/progress.h"
#include "scene/scene.h"

namespace mortise::run {

// Environments of a scene as rows of one model: every step is one for all of them, with one launch of each kernel. Each is a run of its own all the
// same (run.h), with a folder of its own and the bits that it has alone, whatever becomes of the others: one that fails, ends or is reset leaves the
// model, and the others go on.
struct Together {
  std::vector<Options> options;                     // of each environment: its number, its folder
  std::vector<std::unique_ptr<Progress>> progress;  // and where it tells of itself
  // Called when an environment has ended, with what is known here: code, message and seconds.
  std::function<void(std::size_t, const EnvironmentEnd&)> ended;
};
void run_together(Together& environments, const scene::Scene& all, std::span<const scene::EffectTable> tables);

// Throws Error(Exit::usage) naming the line and path of environments.vary where something is to differ that has to be common to a model.
void check_together(const scene::Scene& all);

}  // namespace mortise::run
