#pragma once
#include <span>
#include <string>
#include <vector>

#include "run/options.h"
#include "run/progress.h"
#include "run/routine.h"
#include "run/turn.h"
#include "scene/scene.h"

namespace mortise::run {

// Environment options.environment of a scene as a scene of its own, or one episode of it. With environments.reset its episodes follow each other
// until all have taken time.steps in sum, each in a folder of its own, episode_0003, from the start and with numbers of its own: nothing of one
// reaches the next. Waits, returns and throws as run_one().
Routine<Exit> run_environment(const Options& options, const scene::Scene& all, std::span<const scene::EffectTable> tables, Progress& progress,
                              Turn& turn);

// What an environment's episodes.csv says of an episode that has ended.
struct Episode {
  long first_step = 0, steps = 0;  // in the environment's count; a step that failed counts
  std::string line;                // as written: episode,first_step,steps,ended_by,values
};
// In the order in which they ran; none where there is no such file.
std::vector<Episode> episodes_in(const std::string& folder);
std::string episodes_header(const Params& scene);

}  // namespace mortise::run
