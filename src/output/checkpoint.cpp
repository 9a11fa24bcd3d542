#include "output/checkpoint.h"

#include <unistd.h>

#include <filesystem>

#include "base/error.h"
#include "base/sha256.h"
#include "output/atomic_file.h"

namespace mortise::output {
namespace {

constexpr const char* filetype = "mortise checkpoint";
constexpr std::int64_t version[2] = {3, 2};

// The last bytes of a checkpoint; HDF5 does not look behind its own end. 20 + 64 + 1 bytes.
constexpr std::string_view seal_mark = "\nmortise-sha256-v01=";
constexpr std::size_t seal_size = seal_mark.size() + 64 + 1;

std::string newest(const std::string& dir) { return (std::filesystem::path(dir) / "checkpoint.h5").string(); }
std::string previous(const std::string& dir) { return (std::filesystem::path(dir) / "checkpoint.prev.h5").string(); }

bool present(const std::string& path) { return ::access(path.c_str(), F_OK) == 0; }

}  // namespace

CheckpointWriter::CheckpointWriter(const std::string& dir, const CheckpointInfo& info) : dir_(dir), file_(h5::File::in_memory(newest(dir))) {
  h5::set_text(file_, file_.id(), "filetype", filetype);
  h5::set_integers(file_, file_.id(), "version", version);
  h5::set_text(file_, file_.id(), "mortise_version", info.mortise_version);
  h5::set_text(file_, file_.id(), "scene_sha256", info.scene_sha256);
  h5::set_integer(file_, file_.id(), "step", info.step);
  h5::set_integer(file_, file_.id(), "frames", info.frames);
  h5::set_number(file_, file_.id(), "time", info.time);
  h5::set_integer(file_, file_.id(), "steps", info.steps);
  h5::make_group(file_, file_.id(), "state");
}

void CheckpointWriter::io(std::string_view name, std::vector<double>& values) {
  const std::string full = "state/" + std::string(name), action = "store '" + std::string(name) + "'";
  const hsize_t size = values.size();
  h5::Id links(file_.check(H5Pcreate(H5P_LINK_CREATE), action)), layout = h5::new_layout(file_, action);
  file_.check(H5Pset_create_intermediate_group(links, 1), action);
  h5::Id space(file_.check(H5Screate_simple(1, &size, nullptr), action));
  h5::Id dataset(H5Dcreate2(file_.id(), full.c_str(), H5T_IEEE_F64LE, space, links, layout, H5P_DEFAULT));
  if (dataset < 0) throw Error(Exit::internal, "checkpoint: cannot " + action + ": the name is empty, taken, or also a group");
  if (size > 0) file_.check(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), action);
}

void CheckpointWriter::commit() {
  std::string bytes = file_.image();
  const std::string sum = sha256(bytes);
  bytes.append(seal_mark).append(sum).append("\n");
  const std::string target = newest(dir_), temporary = target + ".tmp";
  write_file(temporary, bytes, true);
  try {
    if (present(target)) keep_file_as(target, previous(dir_));  // so that there is a checkpoint.h5 at any moment
    rename_file(temporary, target);
  } catch (...) {
    ::unlink(temporary.c_str());
    throw;
  }
  sync_folder_of(target);
}

CheckpointReader::CheckpointReader(const std::string& path) : path_(path) {
  std::string bytes = read_file(path);
  const std::string_view all = bytes;
  const bool sealed = all.size() > seal_size && all.substr(all.size() - seal_size, seal_mark.size()) == seal_mark && all.back() == '\n';
  if (!sealed) throw Error(Exit::file, path + ": not a whole checkpoint: the checksum at its end is missing (truncated file?)");
  const std::string_view content = all.substr(0, all.size() - seal_size);
  if (sha256(content) != all.substr(all.size() - 65, 64)) {
    throw Error(Exit::file, path + ": damaged checkpoint: its content does not match its checksum");
  }
  const h5::File file = h5::File::from_image(path, content);
  if (H5Aexists(file.id(), "filetype") <= 0 || h5::get_text(file, file.id(), "filetype") != filetype) {
    throw Error(Exit::file, path + ": not a mortise checkpoint");
  }
  const auto found = h5::get_integers(file, file.id(), "version");
  if (found.size() != 2 || found[0] != version[0]) throw Error(Exit::file, path + ": checkpoint of another format version");
  info_.mortise_version = h5::get_text(file, file.id(), "mortise_version");
  info_.scene_sha256 = h5::get_text(file, file.id(), "scene_sha256");
  info_.step = h5::get_integer(file, file.id(), "step");
  info_.frames = h5::get_integer(file, file.id(), "frames");
  info_.time = h5::get_number(file, file.id(), "time");
  if (H5Aexists(file.id(), "steps") > 0) info_.steps = h5::get_integer(file, file.id(), "steps");
  load(file, h5::open_group(file, file.id(), "state"), "");
}

void CheckpointReader::load(const h5::File& file, hid_t group, const std::string& prefix) {
  for (const std::string& name : h5::members(file, group)) {
    if (h5::is_group(file, group, name)) {
      load(file, h5::open_group(file, group, name), prefix + name + "/");
    } else {
      const h5::Table table = h5::Table::open(file, group, name);
      arrays_.emplace(prefix + name, table.read<double>(file, 0, table.rows()));
    }
  }
}

void CheckpointReader::io(std::string_view name, std::vector<double>& values) {
  const auto at = arrays_.find(name);
  if (at == arrays_.end()) {
    throw Error(Exit::file, path_ + ": the checkpoint has no '" + std::string(name) + "': it belongs to another scene or version");
  }
  values = at->second;
}

bool has_checkpoint(const std::string& dir) { return present(newest(dir)) || present(previous(dir)); }

NewestCheckpoint open_newest_valid(const std::string& dir) {
  std::vector<std::string> skipped;
  for (const std::string& path : {newest(dir), previous(dir)}) {
    try {
      return {CheckpointReader(path), std::move(skipped)};
    } catch (const Error& error) {
      skipped.emplace_back(error.what());
    }
  }
  std::string message = dir + ": no usable checkpoint:";
  for (const std::string& reason : skipped) message += "\n  " + reason;
  throw Error(Exit::file, message);
}

}  // namespace mortise::output
