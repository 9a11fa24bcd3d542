#include "output/field_file.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "base/child.h"
#include "base/error.h"
#include "output/atomic_file.h"
#include "output/descriptions.h"
#include "output/field_layout.h"
#include "output/tuning.h"
#include "output/xdmf.h"

namespace mortise::output {
namespace {

// Names go into HDF5 paths and VTK array names, which bear neither '/' nor '.'.
std::string checked(std::string_view name) {
  const bool good = !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
  if (!good) misuse("the name '" + std::string(name) + "' is not made of letters, digits, '_' and '-'");
  return std::string(name);
}

}  // namespace

FieldFile::FieldFile(const std::string& path, h5::Mode mode, const FieldOptions& options)
    : file_(path, mode), options_(options), keep_(options.fields.begin(), options.fields.end()) {}

FieldFile::~FieldFile() { file_.abandon(); }

int FieldFile::open_ = 0;

// Between frames: of many files at once no datasets stay open, because HDF5 goes through those of all files whenever it writes one out. Opening
// them again costs some milliseconds per frame.
void FieldFile::rest() {
  if (open_ <= tuning::kFilesAtRest) return;
  point_positions_.rest();
  for (std::vector<h5::Table>* tables : {&step_index_, &step_table_})
    for (h5::Table& t : *tables) t.rest();
  const auto rest = [](std::map<std::string, Series>& of) {
    for (auto& [name, series] : of) series.values.rest(), series.index.rest();
  };
  rest(point_fields_), rest(cell_fields_);
  for (auto& [name, group] : effects_) rest(group.rows), rest(group.scalars);
}

template <class F>
void FieldFile::guarded(F&& write) {
  if (broken_) throw Error(Exit::file, file_.path() + ": cannot write: an earlier write failed");
  try {
    write();
  } catch (const Error& error) {
    if (error.code() == Exit::file) {
      broken_ = true;
      file_.abandon();
    }
    throw;
  }
}

std::unique_ptr<FieldFile> FieldFile::open(const std::string& path, const OutputMesh& mesh, const FileInfo& info, const FieldOptions& options) {
  // Under another name until it is whole: what stands at `path` can always be read.
  const std::string aside = path + ".new";
  std::unique_ptr<FieldFile> out(new FieldFile(aside, h5::Mode::create, options));
  try {
    out->guarded([&] {
      out->create(mesh, info);
      out->file_.rename(path);
      out->rest();
    });
  } catch (const Error&) {
    ::unlink(aside.c_str());
    throw;
  }
  return out;
}

std::unique_ptr<FieldFile> FieldFile::reopen(const std::string& path, std::int64_t frames, std::int64_t steps, const FieldOptions& options,
                                             const FileInfo* longer) {
  rehearse(path, frames, steps);
  std::unique_ptr<FieldFile> out(new FieldFile(path, h5::Mode::write, options));
  out->guarded([&] {
    out->load(frames, steps);
    if (longer) out->retell(*longer);
    out->file_.flush();
    out->rest();
  });
  if (out->options_.xdmf) out->write_xdmf();
  return out;
}

// On damaged files HDF5 crashes, or walks in circles. So a copy of this process goes first, with nothing that reaches the disk: it drops
// what is to be dropped and adds a frame.
void FieldFile::rehearse(const std::string& path, std::int64_t frames, std::int64_t steps) {
  std::error_code unknown;
  const auto size = std::filesystem::file_size(path, unknown);
  const ChildLimits limits{20 + (unknown ? 0 : static_cast<unsigned>(size / tuning::kSlowDisk)), std::size_t{4} << 30};
  in_child(
      path + ": damaged", limits,
      [&] {
        FieldFile file(path, h5::Mode::rehearse, {.xdmf = false});
        file.load(frames, steps);
        file.begin_frame(0, std::vector<double>(3 * file.points_n_));
        file.end_frame();
        return std::string();
      },
      Exit::file);
}

h5::Table::Spec FieldFile::real_spec(std::string_view unit, int components, hsize_t chunk_rows, std::string_view description) const {
  return {.type = options_.double_precision ? H5T_IEEE_F64LE : H5T_IEEE_F32LE,
          .components = components,
          .chunk_rows = std::max<hsize_t>(chunk_rows, 1),
          .compress = true,
          .nan_fill = true,
          .unit = std::string(unit),
          .description = std::string(description)};
}

void FieldFile::begin_frame(double time, std::span<const double> positions) {
  if (in_frame_) misuse("begin_frame inside a frame");
  if (positions.size() != 3 * points_n_) misuse("positions do not match the points of the mesh");
  guarded([&] { write_field(point_positions_, frames_ * points_n_, positions); });
  in_frame_ = true;
  time_ = time;
}

void FieldFile::field(Fields& fields, hid_t parent, hid_t offsets, hsize_t count, std::string_view name, std::string_view unit, int components,
                      std::span<const double> data) {
  if (!in_frame_) misuse("a field outside a frame");
  if (!keep_.empty() && !keep_.contains(std::string(name))) return;
  const std::string key = checked(name);
  if (components < 1 || data.size() != count * components) misuse("field '" + key + "' does not match the mesh");
  if (key == body_field) misuse("'body_id' is written by the file itself");
  guarded([&] {
    auto at = fields.find(key);
    if (at == fields.end()) {
      Series series{h5::Table::create(file_, parent, key, real_spec(unit, components, count, description("", key))),
                    h5::Table::create(file_, offsets, key, {.type = H5T_STD_I64LE, .chunk_rows = index_chunk})};
      // Frames before the first: blocks of NaN, which take no space.
      std::vector<std::int64_t> first(static_cast<std::size_t>(frames_));
      for (std::size_t i = 0; i < first.size(); ++i) first[i] = static_cast<std::int64_t>(i * count);
      series.index.write<std::int64_t>(file_, 0, first);
      at = fields.emplace(key, std::move(series)).first;
    }
    Series& series = at->second;
    if (series.written) misuse("field '" + key + "' twice in a frame");
    if (series.values.components() != components) misuse("field '" + key + "' changed its number of components");
    write_field(series.values, frames_ * count, data);
    series.written = true;
  });
}

void FieldFile::write_field(h5::Table& table, hsize_t first, std::span<const double> values) {
  if (values.empty() || table.whole() * table.components() != values.size()) return table.write_real(file_, first, values);
  waiting_.push_back({&table, first});
  waiting_rows_.push_back(table.raw(values));
  waiting_bytes_ += waiting_rows_.back().bytes.size();
  if (waiting_bytes_ > tuning::kWaiting) write_waiting();
}

void FieldFile::write_waiting() {
  const std::vector<std::vector<std::byte>> chunks = h5::compress(waiting_rows_);
  for (std::size_t i = 0; i < waiting_.size(); ++i) waiting_[i].table->write_chunk(file_, waiting_[i].first, chunks[i]);
  waiting_.clear(), waiting_rows_.clear();
  waiting_bytes_ = 0;
}

void FieldFile::points(std::string_view name, std::string_view unit, int components, std::span<const double> data) {
  field(point_fields_, point_data_, point_offsets_, points_n_, name, unit, components, data);
}

void FieldFile::cells(std::string_view name, std::string_view unit, int components, std::span<const double> data) {
  field(cell_fields_, cell_data_, cell_offsets_, cells_n_, name, unit, components, data);
}

FieldFile::EffectGroup& FieldFile::effect(std::string_view name) {
  if (!in_frame_) misuse("a result outside a frame");
  const auto at = effects_.find(name);
  if (at != effects_.end()) return at->second;
  const std::string key = checked(name);
  EffectGroup group;
  group.group = h5::make_group(file_, effects_group_, key);
  if (const std::string_view text = description(key); !text.empty()) h5::set_text(file_, group.group, "description", text);
  group.row_offset = h5::make_group(file_, group.group, "row_offset");
  return effects_.emplace(key, std::move(group)).first->second;
}

void FieldFile::rows(std::string_view group, std::string_view name, std::string_view unit, int components, std::span<const double> data) {
  const std::string key = checked(name);
  if (components < 1 || data.size() % components != 0) misuse("rows '" + key + "' are not whole");
  guarded([&] {
    EffectGroup& owner = effect(group);
    if (key == "row_offset" || owner.scalars.contains(key)) misuse("the name '" + key + "' is taken");
    auto at = owner.rows.find(key);
    if (at == owner.rows.end()) {
      // Not compressed: a chunk that grows would move, and a kill could then hurt rows of earlier frames.
      h5::Table::Spec spec = real_spec(unit, components, 1024, description(group, key));
      spec.compress = false;
      Series series{h5::Table::create(file_, owner.group, key, spec),
                    h5::Table::create(file_, owner.row_offset, key, {.type = H5T_STD_I64LE, .chunk_rows = index_chunk})};
      series.index.write<std::int64_t>(file_, 0, std::vector<std::int64_t>(static_cast<std::size_t>(frames_) + 1, 0));
      at = owner.rows.emplace(key, std::move(series)).first;
    }
    Series& series = at->second;
    if (series.written) misuse("rows '" + key + "' twice in a frame");
    if (series.values.components() != components) misuse("rows '" + key + "' changed their number of components");
    series.values.write_real(file_, series.values.rows(), data);
    series.written = true;
  });
}

void FieldFile::scalar(std::string_view group, std::string_view name, std::string_view unit, double value) {
  const std::string key = checked(name);
  guarded([&] {
    EffectGroup& owner = effect(group);
    if (key == "row_offset" || owner.rows.contains(key)) misuse("the name '" + key + "' is taken");
    auto at = owner.scalars.find(key);
    if (at == owner.scalars.end()) {
      Series series{h5::Table::create(file_, owner.group, key,
                                      {.type = H5T_IEEE_F64LE,
                                       .chunk_rows = index_chunk,
                                       .nan_fill = true,
                                       .unit = std::string(unit),
                                       .description = std::string(description(group, key))}),
                    {}};
      at = owner.scalars.emplace(key, std::move(series)).first;
    }
    if (at->second.written) misuse("scalar '" + key + "' twice in a frame");
    at->second.values.write<double>(file_, frames_, std::span(&value, 1));
    at->second.written = true;
  });
}

void FieldFile::fact(std::string_view group, const char* name, const Fact& value) {
  guarded([&] {
    const hid_t at = effect(group).group;
    if (const auto* text = std::get_if<std::string>(&value)) h5::set_text(file_, at, name, *text);
    if (const auto* count = std::get_if<std::int64_t>(&value)) h5::set_integer(file_, at, name, *count);
    if (const auto* number = std::get_if<double>(&value)) h5::set_number(file_, at, name, *number);
    if (const auto* numbers = std::get_if<std::vector<double>>(&value)) h5::set_numbers(file_, at, name, *numbers);
  });
}

void FieldFile::finish(Fields& fields, hsize_t count) {
  const std::int64_t first = static_cast<std::int64_t>(frames_ * count);
  for (auto& [name, series] : fields) {
    series.values.resize(file_, (frames_ + 1) * count);  // missing in this frame: NaN
    series.index.write<std::int64_t>(file_, frames_, std::span(&first, 1));
    series.written = false;
  }
}

void FieldFile::end_frame() {
  if (!in_frame_) misuse("end_frame without begin_frame");
  guarded([&] {
    write_waiting();
    finish(point_fields_, points_n_);
    finish(cell_fields_, cells_n_);
    for (auto& [name, group] : effects_) {
      for (auto& [key, series] : group.rows) {
        const std::int64_t end = static_cast<std::int64_t>(series.values.rows());
        series.index.write<std::int64_t>(file_, frames_ + 1, std::span(&end, 1));
        series.written = false;
      }
      for (auto& [key, series] : group.scalars) {
        series.values.resize(file_, frames_ + 1);
        series.written = false;
      }
    }
    step_index_[values].write<double>(file_, frames_, std::span(&time_, 1));
    for (std::size_t i = number_of_parts; i < step_index_.size(); ++i) {
      const std::int64_t entry = i == number_of_parts ? 1 : i == point_offsets ? static_cast<std::int64_t>(frames_ * points_n_) : 0;
      step_index_[i].write<std::int64_t>(file_, frames_, std::span(&entry, 1));
    }
    write_steps();
    h5::set_integer(file_, steps_group_, "NSteps", frames_ + 1);
    rest();
    file_.settle();
    ++frames_;
    times_.push_back(time_);
    in_frame_ = false;
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - committed_).count() >= options_.commit_seconds) commit();
  });
}

void FieldFile::commit() {
  file_.flush();
  committed_ = std::chrono::steady_clock::now();
  // Rewriting the sidecar costs time in proportion to its frames; from frame 100 on only every percent.
  if (options_.xdmf && frames_ - sidecar_frames_ >= 1 + frames_ / 100) write_xdmf();
}

void FieldFile::append_step(const StepRow& row) { pending_steps_.push_back(row); }

void FieldFile::write_steps() {
  if (pending_steps_.empty()) return;
  std::vector<double> column(pending_steps_.size());
  for (std::size_t c = 0; c < step_columns.size(); ++c) {
    std::transform(pending_steps_.begin(), pending_steps_.end(), column.begin(), [&](const StepRow& row) { return row.*step_columns[c].value; });
    step_table_[c].write<double>(file_, steps_n_, column);
  }
  steps_n_ += pending_steps_.size();
  pending_steps_.clear();
}

std::vector<StepRow> FieldFile::steps() {
  std::vector<StepRow> out(steps_n_);
  for (std::size_t c = 0; c < step_columns.size(); ++c) {
    const auto column = step_table_[c].read<double>(file_, 0, steps_n_);
    for (std::size_t i = 0; i < column.size(); ++i) out[i].*step_columns[c].value = column[i];
  }
  return out;
}

void FieldFile::flush() {
  guarded([&] {
    write_steps();
    rest();
    commit();
  });
}

void FieldFile::close() {
  if (broken_) return;
  if (in_frame_) misuse("close inside a frame");
  guarded([&] {
    write_steps();
    rest();
    file_.close();
  });
  if (options_.xdmf) write_xdmf();
}

void FieldFile::write_xdmf() {
  sidecar_frames_ = frames_;
  XdmfDescription d;
  const std::filesystem::path path(file_.path());
  d.hdf5_name = path.filename().string();
  d.times = times_;
  d.points = points_n_, d.cells = cells_n_;
  d.uniform_type = uniform_type_;
  d.topology_size = uniform_type_ != 0 ? connectivity_n_ : mixed_n_;
  d.precision = options_.double_precision ? 8 : 4;
  d.fields.push_back({body_field, false, true, 1});
  d.fields.push_back({body_field, true, true, 1});
  for (const auto& [name, series] : point_fields_) d.fields.push_back({name, false, false, series.values.components()});
  for (const auto& [name, series] : cell_fields_) d.fields.push_back({name, true, false, series.values.components()});
  write_file_atomically(std::filesystem::path(path).replace_extension(".xdmf").string(), xdmf_text(d), false);
}

}  // namespace mortise::output
