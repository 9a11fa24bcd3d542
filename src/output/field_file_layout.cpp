// Making the groups and datasets of a field file, and finding them again in a file of an earlier run.
#include <algorithm>
#include <ctime>
#include <functional>

#include "base/error.h"
#include "output/field_file.h"
#include "output/field_layout.h"
#include "output/xdmf.h"

namespace mortise::output {
namespace {

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
    h5::Table::create(f, table, column.name,
                      {.type = H5T_IEEE_F64LE, .chunk_rows = index_chunk, .unit = column.unit, .description = column.description});
  }
  open_groups();
  file_.flush();
}

void FieldFile::retell(const FileInfo& info) {
  const h5::File& f = file_;
  const h5::Id ours = h5::open_group(f, f.id(), "mortise");
  h5::remove(f, ours, "scene");
  h5::write_text(f, ours, "scene", info.scene_text);
  h5::remove_attribute(f, f.id(), "scene_sha256");
  h5::set_text(f, f.id(), "scene_sha256", info.scene_sha256);
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
    throw Error(Exit::file,
                f.path() + ": cannot continue after step " + std::to_string(steps) + ": the file holds " + std::to_string(step_table_[0].rows()));
  }
  h5::set_integer(f, steps_group_, "NSteps", frames);
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
}

}  // namespace mortise::output
