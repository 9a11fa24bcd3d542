#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/archive.h"
#include "output/h5.h"

namespace mortise::output {

// Checkpoints: DIR/checkpoint.h5 and, one older, DIR/checkpoint.prev.h5. Plain HDF5 with every named array as a float64 dataset
// ('/' in a name makes groups) and, behind the HDF5 bytes, a line with their SHA-256 (schemas/fields.md).

struct CheckpointInfo {
  std::string mortise_version;
  std::string scene_sha256;
  std::int64_t step = 0;    // steps done
  std::int64_t frames = 0;  // frames of the field file at that moment
  double time = 0;          // [s]
  std::int64_t steps = 0;   // of the scene; 0: not known
};

class CheckpointWriter : public Archive {
 public:
  CheckpointWriter(const std::string& dir, const CheckpointInfo& info);
  bool loading() const override { return false; }
  void io(std::string_view name, std::vector<double>& values) override;  // every name once
  using Archive::io;
  // Writes, fsyncs and renames; only then the checkpoint exists. The newest becomes the previous one. Throws Error(Exit::file)
  // and leaves what was there before.
  void commit();

 private:
  std::string dir_;
  h5::File file_;
};

class CheckpointReader : public Archive {
 public:
  // Reads and verifies the whole file. Throws Error(Exit::file) that says what is wrong with it.
  explicit CheckpointReader(const std::string& path);
  bool loading() const override { return true; }
  // Throws Error(Exit::file) if the checkpoint has no array of that name.
  void io(std::string_view name, std::vector<double>& values) override;
  using Archive::io;
  const CheckpointInfo& info() const { return info_; }
  const std::string& path() const { return path_; }
  const std::map<std::string, std::vector<double>, std::less<>>& arrays() const { return arrays_; }

 private:
  void load(const h5::File& file, hid_t group, const std::string& prefix);
  std::string path_;
  CheckpointInfo info_;
  std::map<std::string, std::vector<double>, std::less<>> arrays_;
};

struct NewestCheckpoint {
  CheckpointReader reader;
  std::vector<std::string> skipped;  // why newer ones could not be used, one message each
};

// True if `dir` holds any checkpoint, good or not.
bool has_checkpoint(const std::string& dir);
// The newest checkpoint of `dir` that is whole. Throws Error(Exit::file) naming every file tried and what is wrong with it.
NewestCheckpoint open_newest_valid(const std::string& dir);

}  // namespace mortise::output
