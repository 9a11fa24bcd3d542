#include "output/field_file.h"

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <limits>

#include "base/error.h"
#include "output/atomic_file.h"
#include "output/xdmf.h"

namespace mortise::output {
namespace {

// Static arrays of VTKHDF keep their one copy at offset 0 in every frame.
constexpr const char* body_field = "body_id";
constexpr hsize_t index_chunk = 512;

enum StepIndex { values, number_of_parts, part_offsets, point_offsets, cell_offsets, connectivity_offsets };
constexpr const char* step_index_names[] = {"Values",       "NumberOfParts", "PartOffsets",
                                            "PointOffsets", "CellOffsets",   "ConnectivityIdOffsets"};

[[noreturn]] void misuse(const std::string& what) { throw Error(Exit::internal, "field file: " + what); }

// Names go into HDF5 paths and VTK array names, which bear neither '/' nor '.'.
std::string checked(std::string_view name) {
  const bool good = !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
  if (!good) misuse("the name '" + std::string(name) + "' is not made of letters, digits, '_' and '-'");
  return std::string(name);
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

template <class T>
void write_constant(const h5::File& file, hid_t parent, const char* name, hid_t type, int components, const std::vector<T>& data,
                    const char* unit = "1") {
  const hsize_t rows = data.size() / components;
  h5::Table table = h5::Table::create(
      file, parent, name, {.type = type, .components = components, .chunk_rows = std::max<hsize_t>(rows, 1), .compress = true, .unit = unit});
  table.write<T>(file, 0, data);
}

}  // namespace

FieldFile::FieldFile(const std::string& path, h5::Mode mode, const FieldOptions& options)
    : file_(path, mode), options_(options), keep_(options.fields.begin(), options.fields.end()) {}

FieldFile::~FieldFile() { file_.abandon(); }

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

std::unique_ptr<FieldFile> FieldFile::open(const std::string& path, const OutputMesh& mesh, const FileInfo& info,
                                           const FieldOptions& options) {
  std::unique_ptr<FieldFile> out(new FieldFile(path, h5::Mode::create, options));
  out->guarded([&] { out->create(mesh, info); });
  return out;
}

std::unique_ptr<FieldFile> FieldFile::reopen(const std::string& path, std::int64_t frames, std::int64_t steps,
                                             const FieldOptions& options) {
  std::unique_ptr<FieldFile> out(new FieldFile(path, h5::Mode::write, options));
  out->guarded([&] { out->load(frames, steps); });
  return out;
}

h5::Table::Spec FieldFile::real_spec(std::string_view unit, int components, hsize_t chunk_rows) const {
  return {.type = options_.double_precision ? H5T_IEEE_F64LE : H5T_IEEE_F32LE,
          .components = components,
          .chunk_rows = std::max<hsize_t>(chunk_rows, 1),
          .compress = true,
          .nan_fill = true,
          .unit = std::string(unit)};
}

void FieldFile::create(const OutputMesh& mesh, const FileInfo& info) {
  const h5::File& f = file_;
  points_n_ = mesh.points.size(), cells_n_ = mesh.cells(), connectivity_n_ = mesh.connectivity.size();
  if (mesh.offsets.size() != cells_n_ + 1 || mesh.body_of_cell.size() != cells_n_ || mesh.body_of_point.size() != points_n_) {
    misuse("the mesh arrays disagree in length");
  }
  h5::set_text(f, f.id(), "filetype", "mortise fields");
  h5::set_integers(f, f.id(), "version", field_file_version);
  h5::set_text(f, f.id(), "mortise_version", info.mortise_version);
  h5::set_text(f, f.id(), "git_sha1", info.git_sha1);
  h5::set_text(f, f.id(), "date_and_time", utc_now());
  h5::set_text(f, f.id(), "scene_sha256", info.scene_sha256);

  root_ = h5::make_group(f, f.id(), "VTKHDF");
  const std::int64_t vtk_version[2] = {2, 2};
  h5::set_integers(f, root_, "Version", vtk_version);
  h5::set_fixed_ascii(f, root_, "Type", "UnstructuredGrid");
  const auto one = [](hsize_t n) { return std::vector<std::int64_t>{static_cast<std::int64_t>(n)}; };
  write_constant(f, root_, "NumberOfPoints", H5T_STD_I64LE, 1, one(points_n_));
  write_constant(f, root_, "NumberOfCells", H5T_STD_I64LE, 1, one(cells_n_));
  write_constant(f, root_, "NumberOfConnectivityIds", H5T_STD_I64LE, 1, one(connectivity_n_));
  write_constant(f, root_, "Connectivity", H5T_STD_I64LE, 1, mesh.connectivity);
  write_constant(f, root_, "Offsets", H5T_STD_I64LE, 1, mesh.offsets);
  write_constant(f, root_, "Types", H5T_STD_U8LE, 1, mesh.types);
  h5::Table::create(f, root_, "Points", real_spec("m", 3, points_n_));

  h5::Id point_data = h5::make_group(f, root_, "PointData"), cell_data = h5::make_group(f, root_, "CellData");
  write_constant(f, point_data, body_field, H5T_STD_I32LE, 1, mesh.body_of_point);
  write_constant(f, cell_data, body_field, H5T_STD_I32LE, 1, mesh.body_of_cell);

  h5::Id steps = h5::make_group(f, root_, "Steps");
  h5::set_integer(f, steps, "NSteps", 0);
  for (int i = values; i <= connectivity_offsets; ++i) {
    h5::Table::create(f, steps, step_index_names[i],
                      {.type = i == values ? H5T_IEEE_F64LE : H5T_STD_I64LE,
                       .column = i == cell_offsets || i == connectivity_offsets,  // (steps, topologies)
                       .chunk_rows = index_chunk,
                       .unit = i == values ? "s" : "1"});
  }
  for (const char* name : {"PointDataOffsets", "CellDataOffsets"}) {
    h5::Id group = h5::make_group(f, steps, name);
    h5::Table::create(f, group, body_field, {.type = H5T_STD_I64LE, .chunk_rows = index_chunk});
  }

  h5::Id ours = h5::make_group(f, f.id(), "mortise");
  h5::write_text(f, ours, "scene", info.scene_text);
  h5::Id mesh_group = h5::make_group(f, ours, "mesh");
  std::vector<double> rest;
  rest.reserve(3 * points_n_);
  for (const Vec3& x : mesh.points) rest.insert(rest.end(), x.data(), x.data() + 3);
  write_constant(f, mesh_group, "rest_points", H5T_IEEE_F64LE, 3, rest, "m");
  std::string names;
  for (const std::string& name : mesh.body_names) names += name + "\n";
  h5::write_text(f, mesh_group, "body_names", names);
  const bool uniform = std::adjacent_find(mesh.types.begin(), mesh.types.end(), std::not_equal_to<>()) == mesh.types.end();
  if (!uniform) {
    std::vector<std::int64_t> mixed;
    for (std::size_t c = 0; c < cells_n_; ++c) {
      mixed.push_back(xdmf_code(mesh.types[c]));
      for (std::int64_t k = mesh.offsets[c]; k < mesh.offsets[c + 1]; ++k) mixed.push_back(mesh.connectivity.at(k));
    }
    write_constant(f, mesh_group, "xdmf_topology", H5T_STD_I64LE, 1, mixed);
  }
  h5::make_group(f, ours, "effects");
  h5::Id table = h5::make_group(f, ours, "steps");
  for (const StepColumn& column : step_columns) {
    h5::Table::create(f, table, column.name, {.type = H5T_IEEE_F64LE, .chunk_rows = index_chunk, .unit = column.unit});
  }
  open_groups();
  file_.flush();
}

void FieldFile::open_groups() {
  const h5::File& f = file_;
  root_ = h5::open_group(f, f.id(), "VTKHDF");
  steps_group_ = h5::open_group(f, root_, "Steps");
  point_data_ = h5::open_group(f, root_, "PointData");
  cell_data_ = h5::open_group(f, root_, "CellData");
  point_offsets_ = h5::open_group(f, steps_group_, "PointDataOffsets");
  cell_offsets_ = h5::open_group(f, steps_group_, "CellDataOffsets");
  effects_group_ = h5::open_group(f, f.id(), "mortise/effects");
  step_table_group_ = h5::open_group(f, f.id(), "mortise/steps");
  point_positions_ = h5::Table::open(f, root_, "Points");
  options_.double_precision = !point_positions_.single();
  const auto size = [&](const char* name) { return static_cast<hsize_t>(h5::Table::open(f, root_, name).read<std::int64_t>(f, 0, 1)[0]); };
  points_n_ = size("NumberOfPoints"), cells_n_ = size("NumberOfCells"), connectivity_n_ = size("NumberOfConnectivityIds");
  h5::Id mesh_group = h5::open_group(f, f.id(), "mortise/mesh");
  if (h5::exists(f, mesh_group, "xdmf_topology")) {
    mixed_n_ = h5::Table::open(f, mesh_group, "xdmf_topology").rows();
  } else {
    uniform_type_ = cells_n_ > 0 ? h5::Table::open(f, root_, "Types").read<std::uint8_t>(f, 0, 1)[0] : std::uint8_t(tetrahedron);
  }
  for (const char* name : step_index_names) step_index_.push_back(h5::Table::open(f, steps_group_, name));
  step_index_.push_back(h5::Table::open(f, point_offsets_, body_field));
  step_index_.push_back(h5::Table::open(f, cell_offsets_, body_field));
  for (const StepColumn& column : step_columns) step_table_.push_back(h5::Table::open(f, step_table_group_, column.name));
}

void FieldFile::load(std::int64_t frames, std::int64_t steps) {
  const h5::File& f = file_;
  if (H5Aexists(f.id(), "filetype") <= 0 || h5::get_text(f, f.id(), "filetype") != "mortise fields") {
    throw Error(Exit::file, f.path() + ": not a mortise field file");
  }
  const auto version = h5::get_integers(f, f.id(), "version");
  if (version.size() != 2 || version[0] != field_file_version[0]) {
    throw Error(Exit::file, f.path() + ": its format version is not the one this mortise continues; start a new run");
  }
  open_groups();
  const std::int64_t there = h5::get_integer(f, steps_group_, "NSteps");
  if (frames < 0 || frames > there) {
    throw Error(Exit::file, f.path() + ": cannot continue after frame " + std::to_string(frames) + ": the file holds " + std::to_string(there));
  }
  if (steps < 0 || static_cast<hsize_t>(steps) > step_table_[0].rows()) {
    throw Error(Exit::file, f.path() + ": cannot continue after step " + std::to_string(steps) + ": the file holds " +
                                std::to_string(step_table_[0].rows()));
  }
  // First forget the frames, then drop their data: a kill in between leaves a whole file.
  h5::set_integer(f, steps_group_, "NSteps", frames);
  file_.flush();
  frames_ = frames, steps_n_ = static_cast<hsize_t>(steps);
  const hsize_t n = static_cast<hsize_t>(frames);
  for (auto& table : step_index_) table.resize(f, n);
  for (auto& table : step_table_) table.resize(f, steps_n_);
  point_positions_.resize(f, n * points_n_);
  for (auto* kind : {&point_fields_, &cell_fields_}) {
    const bool on_points = kind == &point_fields_;
    const hid_t group = on_points ? point_data_ : cell_data_;
    for (const std::string& name : h5::members(f, group)) {
      if (name == body_field) continue;
      Series series{h5::Table::open(f, group, name), h5::Table::open(f, on_points ? point_offsets_ : cell_offsets_, name)};
      series.values.resize(f, n * (on_points ? points_n_ : cells_n_));
      series.index.resize(f, n);
      kind->emplace(name, std::move(series));
    }
  }
  for (const std::string& name : h5::members(f, effects_group_)) {
    EffectGroup group{h5::open_group(f, effects_group_, name), h5::open_group(f, effects_group_, name + "/row_offset"), {}, {}};
    for (const std::string& member : h5::members(f, group.group)) {
      if (member == "row_offset") continue;
      Series series{h5::Table::open(f, group.group, member), {}};
      if (h5::exists(f, group.row_offset, member)) {
        series.index = h5::Table::open(f, group.row_offset, member);
        series.values.resize(f, static_cast<hsize_t>(series.index.read<std::int64_t>(f, n, 1)[0]));
        series.index.resize(f, n + 1);
        group.rows.emplace(member, std::move(series));
      } else {
        series.values.resize(f, n);
        group.scalars.emplace(member, std::move(series));
      }
    }
    effects_.emplace(name, std::move(group));
  }
  times_ = step_index_[values].read<double>(f, 0, n);
  file_.flush();
  if (options_.xdmf) write_xdmf();
}

void FieldFile::begin_frame(double time, std::span<const double> positions) {
  if (in_frame_) misuse("begin_frame inside a frame");
  if (positions.size() != 3 * points_n_) misuse("positions do not match the points of the mesh");
  guarded([&] { point_positions_.write_real(file_, frames_ * points_n_, positions); });
  in_frame_ = true;
  time_ = time;
}

void FieldFile::field(Fields& fields, hid_t parent, hid_t offsets, hsize_t count, std::string_view name, std::string_view unit,
                      int components, std::span<const double> data) {
  if (!in_frame_) misuse("a field outside a frame");
  if (!keep_.empty() && !keep_.contains(std::string(name))) return;
  const std::string key = checked(name);
  if (components < 1 || data.size() != count * components) misuse("field '" + key + "' does not match the mesh");
  if (key == body_field) misuse("'body_id' is written by the file itself");
  guarded([&] {
    auto at = fields.find(key);
    if (at == fields.end()) {
      Series series{h5::Table::create(file_, parent, key, real_spec(unit, components, count)),
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
    series.values.write_real(file_, frames_ * count, data);
    series.written = true;
  });
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
      h5::Table::Spec spec = real_spec(unit, components, 1024);
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
                                      {.type = H5T_IEEE_F64LE, .chunk_rows = index_chunk, .nan_fill = true, .unit = std::string(unit)}),
                    {}};
      at = owner.scalars.emplace(key, std::move(series)).first;
    }
    if (at->second.written) misuse("scalar '" + key + "' twice in a frame");
    at->second.values.write<double>(file_, frames_, std::span(&value, 1));
    at->second.written = true;
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
    // The frame exists once NSteps counts it: its data go to the disk before.
    file_.flush();
    h5::set_integer(file_, steps_group_, "NSteps", frames_ + 1);
    file_.flush();
    ++frames_;
    times_.push_back(time_);
  });
  in_frame_ = false;
  // Rewriting the sidecar costs time in proportion to its frames; from frame 100 on only every percent.
  if (options_.xdmf && frames_ % (1 + frames_ / 100) == 0) write_xdmf();
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

void FieldFile::flush() {
  guarded([&] {
    write_steps();
    file_.flush();
  });
}

void FieldFile::close() {
  if (broken_) return;
  if (in_frame_) misuse("close inside a frame");
  guarded([&] {
    write_steps();
    file_.flush();
    file_.close();
  });
  if (options_.xdmf) write_xdmf();
}

void FieldFile::write_xdmf() const {
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
