#pragma once
// `environments`: N copies of a scene that differ in numbers drawn at random. Each is a scene of its own: what a draw gives is written in the place
// of the scene's number, and the block itself is left out. A draw hangs on the seed, the environment, the episode and the path alone.
#include <set>
#include <span>
#include <string>
#include <vector>

#include "base/param_table.h"
#include "base/params.h"
#include "scene/diagnostics.h"
#include "scene/scene.h"
#include "scene/yaml.h"

namespace mortise::scene {

const ParamTable& environments_table();

// Every path names a number that may differ, and all that is drawn for it in the first episode is in its range. `written`: the file's tree.
void check_environments(const Node& written, const Params& root, const ParamTable& table, const std::set<std::string>& incomplete,
                        Diagnostics& errors);

// How many there are; 0 of a scene without the block.
long environment_count(const Params& root);

struct Drawn {
  std::string path;
  double draw = 0, value = 0;  // what the distribution gave, and the number that it makes [SI]
};
std::vector<Drawn> draw(const Params& root, long environment, long episode);

// An environment as a scene of its own. one_environment: also of a number that a user gave, Error(Exit::usage) where there is none such. Throws
// SceneErrors where what was drawn makes a scene invalid.
Scene environment_of(const Scene& all, const std::vector<std::string>& overrides, std::span<const EffectTable> effects, long environment,
                     long episode = 0);
Scene one_environment(const Scene& all, const std::vector<std::string>& overrides, std::span<const EffectTable> effects, long environment,
                      long episode = 0);

}  // namespace mortise::scene
