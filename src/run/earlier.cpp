#include "run/earlier.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "base/error.h"
#include "output/field_reader.h"
#include "output/run_json.h"
#include "scene/differences.h"
#include "scene/environments.h"

namespace fs = std::filesystem;

namespace mortise::run {

namespace {

// Identity of the scene whose results a folder holds; "" where nothing tells.
std::string scene_in(const std::string& folder) {
  if (const std::string ended = output::scene_of_run(folder + "/run.json"); !ended.empty()) return ended;
  if (!output::has_checkpoint(folder)) return {};
  try {
    return output::open_newest_valid(folder).reader.info().scene_sha256;
  } catch (const Error&) {  // said where it is to be continued
    return {};
  }
}

// Load steps divide a scene; environments and episodes are told apart by all of it.
bool may_be_longer(const Options& options, const Params& scene) {
  return options.environment < 0 && options.resets.empty() && scene.at("time").text("mode") != "static";
}

// Was the checkpoint's scene this one with another number of steps, and are there steps left?
bool is_but_for_steps(Params scene, const output::CheckpointInfo& info) {
  Params time = scene.at("time");
  if (info.steps <= 0 || time.integer("steps") <= info.step) return false;
  time.set("steps", Params::make_integer(info.steps));
  scene.set("time", time);
  return scene::identity(scene) == info.scene_sha256;
}

// As far as the folder's field file tells.
std::string what_differs(const std::string& folder, const output::CheckpointInfo& info, const Params& scene) {
  constexpr std::size_t kTold = 3;
  std::vector<std::string> lines;
  try {
    const output::FieldReader there(folder + "/fields.vtkhdf");
    lines = scene::differences(there.scene_text(), scene::to_yaml(scene));
    lines.erase(std::remove_if(lines.begin(), lines.end(), [](const std::string& line) { return line.find(".file is ") != std::string::npos; }),
                lines.end());  // what they hold counts, not where they lie
    if (lines.empty()) return ": a file that it names is another one";
  } catch (const Error&) {
    return ", other --set values or other mesh files";
  }
  std::string text = ":";
  for (std::size_t i = 0; i < std::min(lines.size(), kTold); ++i) text += "\n  " + lines[i];
  if (lines.size() > kTold) text += fmt::format("\n  and {} more", lines.size() - kTold);
  if (lines.size() == 1 && lines[0].rfind("time.steps is", 0) == 0) text += fmt::format("; {} are done", info.step);
  return text;
}

}  // namespace

std::unique_ptr<output::NewestCheckpoint> open_checkpoint(const Options& options, const std::string& folder, const Params& scene,
                                                          const std::string& hash) {
  if (options.resume.empty()) return nullptr;
  if (!output::has_checkpoint(folder)) {
    if (options.resume == "auto") return nullptr;
    throw Error(Exit::file, "--resume: '" + folder + "' has no checkpoint (use --resume=auto to start afresh then)");
  }
  auto out = std::make_unique<output::NewestCheckpoint>(output::open_newest_valid(folder));
  const output::CheckpointInfo& info = out->reader.info();
  if (info.scene_sha256 == hash || (may_be_longer(options, scene) && is_but_for_steps(scene, info))) return out;
  throw Error(Exit::file, "the checkpoint in '" + folder + "' belongs to another scene" + what_differs(folder, info, scene));
}

bool is_of_environment(const std::string& folder, const scene::Scene& all, const Options& options, std::span<const scene::EffectTable> tables,
                       long environment) {
  const std::string there = scene_in(all.root.at("environments").has("reset") ? episode_folder(folder, 0) : folder);
  if (there.empty()) return false;
  if (scene::identity(scene::environment_of(all, options.overrides, tables, environment).root) != there)
    throw Error(Exit::file, "the results in '" + folder + "' belong to another scene, other --set values or other mesh files");
  return true;
}

void clear_folder(const Options& options, const Folder& folder) {
  if (!folder.used()) return;
  const std::string fields = folder.file("fields.vtkhdf");
  if (!options.overwrite && options.resume.empty())
    throw Error(Exit::usage, "'" + folder.path() + "' is not empty; use --overwrite to replace its results, --resume to continue, or another -o");
  std::error_code ec;
  if (!options.overwrite && fs::exists(fs::symlink_status(fields, ec))) {
    const output::FieldReader there(fields);
    if (there.frames() > 1)
      throw Error(Exit::file, "'" + fields + "' holds " + std::to_string(there.frames()) +
                                  " frames, but there is no checkpoint to go on from; --overwrite replaces them");
  }
  folder.remove_results();
}

}  // namespace mortise::run
