#include "run/earlier.h"

#include <filesystem>

#include "base/error.h"
#include "output/field_reader.h"
#include "output/run_json.h"
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

}  // namespace

std::unique_ptr<output::NewestCheckpoint> open_checkpoint(const Options& options, const std::string& folder, const std::string& hash) {
  if (options.resume.empty()) return nullptr;
  if (!output::has_checkpoint(folder)) {
    if (options.resume == "auto") return nullptr;
    throw Error(Exit::file, "--resume: '" + folder + "' has no checkpoint (use --resume=auto to start afresh then)");
  }
  auto out = std::make_unique<output::NewestCheckpoint>(output::open_newest_valid(folder));
  if (out->reader.info().scene_sha256 != hash)
    throw Error(Exit::file, "the checkpoint in '" + folder + "' belongs to another scene, other --set values or other mesh files");
  return out;
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
