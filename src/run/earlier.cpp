#include "run/earlier.h"

#include <filesystem>

#include "base/error.h"
#include "output/field_reader.h"

namespace fs = std::filesystem;

namespace mortise::run {

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

void clear_folder(const Options& options, const Folder& folder, const std::string& hash) {
  if (!folder.used()) return;
  const std::string fields = folder.file("fields.vtkhdf");
  if (!options.overwrite && options.resume.empty())
    throw Error(Exit::usage, "'" + folder.path() + "' is not empty; use --overwrite to replace its results, --resume to continue, or another -o");
  std::error_code ec;
  if (!options.overwrite && fs::exists(fs::symlink_status(fields, ec))) {
    const output::FieldReader there(fields);
    if (there.scene_sha256() != hash || there.frames() > 1)
      throw Error(Exit::file, "'" + fields + "' holds " + std::to_string(there.frames()) +
                                  " frames, but there is no checkpoint to go on from; --overwrite replaces them");
  }
  folder.remove_results();
}

}  // namespace mortise::run
