#pragma once
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/field_sink.h"
#include "output/h5.h"
#include "output/mesh.h"
#include "output/step_row.h"

namespace mortise::output {

inline constexpr std::int64_t field_file_version[2] = {1, 0};  // schemas/fields.md

// Where a file comes from; stored as attributes and as /mortise/scene.
struct FileInfo {
  std::string mortise_version;
  std::string git_sha1;
  std::string scene_text;    // resolved scene, YAML
  std::string scene_sha256;  // of scene_text
};

struct FieldOptions {
  bool double_precision = false;      // points and fields as 64-bit floats instead of 32
  std::vector<std::string> fields{};  // point and cell fields to keep; empty = all. Rows and scalars are always kept
  bool xdmf = true;                   // write the sidecar beside it: same path, extension .xdmf
  double commit_seconds = 0;          // frames that end sooner after the last commit are committed with a later one, or with flush()
};

// What is said once about a group: text, a count, or numbers (their unit in the name: `width_m`).
using Fact = std::variant<std::string, std::int64_t, double, std::vector<double>>;

// Writes fields.vtkhdf (schemas/fields.md), a temporal VTKHDF file. It goes from frame to frame in one step (paged_file.h): after
// end_frame() (with `commit_seconds`: after flush()) the frame survives a kill and a power cut, before it there is no trace of it. Every failing
// write throws Error(Exit::file) and leaves the frames before readable; nothing can be written then.
class FieldFile : public FieldSink {
 public:
  // Creates (or replaces) `path`, which is there when it is whole.
  static std::unique_ptr<FieldFile> open(const std::string& path, const OutputMesh& mesh, const FileInfo& info, const FieldOptions& options);
  // Goes on with a file of an earlier run: keeps the first `frames` frames and the first `steps` rows of the step table and
  // drops the rest. Precision stays what it was. longer: of a scene that the run goes on with, if that is another one. Throws Error(Exit::file) if
  // the file holds fewer.
  static std::unique_ptr<FieldFile> reopen(const std::string& path, std::int64_t frames, std::int64_t steps, const FieldOptions& options,
                                           const FileInfo* longer = nullptr);
  ~FieldFile() override;  // without close(): what end_frame() did not finish is lost

  // `points`: current positions [m], x y z per point of the mesh.
  void begin_frame(double time, std::span<const double> points);
  void points(std::string_view name, std::string_view unit, int components, std::span<const double> values) override;
  void cells(std::string_view name, std::string_view unit, int components, std::span<const double> values) override;
  void rows(std::string_view group, std::string_view name, std::string_view unit, int components, std::span<const double> values) override;
  void scalar(std::string_view group, std::string_view name, std::string_view unit, double value) override;
  void fact(std::string_view group, const char* name, const Fact& value);  // of an effect's group; once, in any frame
  void end_frame();
  void append_step(const StepRow& row);  // reaches the disk with the next end_frame(), flush() or close()
  std::vector<StepRow> steps();          // so far, without those that have not reached it
  void flush();                          // what a checkpoint needs before it may count the frames and steps done
  bool can_flush() const { return !broken_ && !in_frame_ && file_.id() >= 0; }
  void close();

  std::int64_t frames() const { return frames_; }

 private:
  struct Series {
    h5::Table values;
    h5::Table index;  // per frame: first row (fields), or one past the last row (rows)
    bool written = false;
  };
  struct EffectGroup {
    h5::Id group, row_offset;
    std::map<std::string, Series> rows;
    std::map<std::string, Series> scalars;
  };
  using Fields = std::map<std::string, Series>;

  FieldFile(const std::string& path, h5::Mode mode, const FieldOptions& options);
  void create(const OutputMesh& mesh, const FileInfo& info);
  void load(std::int64_t frames, std::int64_t steps);
  void retell(const FileInfo& info);  // the scene
  static void rehearse(const std::string& path, std::int64_t frames, std::int64_t steps);
  void open_groups();
  void rest();
  // Runs `write`; after a failure the file is left as of the last finished frame.
  template <class F>
  void guarded(F&& write);
  void field(Fields& fields, hid_t parent, hid_t offsets, hsize_t count, std::string_view name, std::string_view unit, int components,
             std::span<const double> values);
  void write_field(h5::Table& table, hsize_t first, std::span<const double> values);
  void write_waiting();
  void finish(Fields& fields, hsize_t count);
  EffectGroup& effect(std::string_view name);
  void write_steps();
  void commit();
  void write_xdmf();
  h5::Table::Spec real_spec(std::string_view unit, int components, hsize_t chunk_rows, std::string_view description = "") const;

  static int open_;  // files that this process writes
  struct Counted {
    Counted() { ++open_; }
    ~Counted() { --open_; }
  };

  h5::File file_;
  Counted counted_;
  FieldOptions options_;
  std::set<std::string> keep_;
  bool broken_ = false, in_frame_ = false;
  std::int64_t frames_ = 0, sidecar_frames_ = 0;
  std::chrono::steady_clock::time_point committed_ = std::chrono::steady_clock::now();
  double time_ = 0;
  hsize_t points_n_ = 0, cells_n_ = 0, connectivity_n_ = 0;
  std::uint8_t uniform_type_ = 0;  // the type of all cells, 0 if they differ
  hsize_t mixed_n_ = 0;            // length of /mortise/mesh/xdmf_topology, 0 if uniform
  std::vector<double> times_;
  std::vector<StepRow> pending_steps_;
  hsize_t steps_n_ = 0;

  h5::Id root_, steps_group_, point_data_, cell_data_, point_offsets_, cell_offsets_, effects_group_, step_table_group_;
  h5::Table point_positions_;
  std::vector<h5::Table> step_index_;  // VTKHDF/Steps: Values, NumberOfParts, PartOffsets, PointOffsets, CellOffsets, ...
  Fields point_fields_, cell_fields_;
  std::map<std::string, EffectGroup, std::less<>> effects_;
  std::vector<h5::Table> step_table_;

  // Fields of the frame whose chunks are still to be made: all at once, on all threads.
  struct Waiting {
    h5::Table* table;
    hsize_t first;
  };
  std::vector<Waiting> waiting_;
  std::vector<h5::Raw> waiting_rows_;
  std::size_t waiting_bytes_ = 0;
};

}  // namespace mortise::output
