#pragma once
// What an earlier run left in the folder of a new one.
#include <memory>
#include <span>
#include <string>

#include "output/checkpoint.h"
#include "run/folder.h"
#include "run/options.h"
#include "scene/scene.h"

namespace mortise::run {

// Whether to continue, and from what; notes what was skipped. hash: identity of the scene. That of the checkpoint may have another number of steps,
// but more than are done, in a motion of its own. Throws Error(Exit::file).
std::unique_ptr<output::NewestCheckpoint> open_checkpoint(const Options& options, const std::string& folder, const Params& scene,
                                                          const std::string& hash);

// Whether the results in `folder` are of that environment of the scene, of its first episode where it has such; false where nothing tells. Throws
// Error(Exit::file) where they are of another scene: episodes that have ended are not run again.
bool is_of_environment(const std::string& folder, const scene::Scene& all, const Options& options, std::span<const scene::EffectTable> tables,
                       long environment);

// Takes away what a run without a checkpoint may replace: results that --overwrite gives up, and a start that was cut short before its first
// checkpoint. Throws Error(Exit::usage) or Error(Exit::file) where there is more.
void clear_folder(const Options& options, const Folder& folder);

}  // namespace mortise::run
