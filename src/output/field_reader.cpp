#include "output/field_reader.h"

#include <sstream>

#include "base/error.h"
#include "output/field_file.h"

namespace mortise::output {

FieldReader::FieldReader(const std::string& path) : file_(path, h5::Mode::read) {
  const h5::File& f = file_;
  const std::string type = H5Aexists(f.id(), "filetype") > 0 ? h5::get_text(f, f.id(), "filetype") : "";
  if (type == "mortise environments") throw Error(Exit::file, path + ": holds environments; each has fields of its own (env_0000/fields.vtkhdf)");
  if (type != "mortise fields") throw Error(Exit::file, path + ": not a mortise field file");
  const auto version = h5::get_integers(f, f.id(), "version");
  if (version.size() != 2 || version[0] != field_file_version[0]) {
    throw Error(Exit::file, path + ": written in format version " + (version.empty() ? "?" : std::to_string(version[0])) +
                                ", this mortise reads version " + std::to_string(field_file_version[0]));
  }
  h5::Id root = h5::open_group(f, f.id(), "VTKHDF"), steps = h5::open_group(f, root, "Steps");
  h5::Id mesh = h5::open_group(f, f.id(), "mortise/mesh"), ours = h5::open_group(f, f.id(), "mortise");
  scene_text_ = h5::read_text(f, ours, "scene");

  const auto all = [&]<class T>(hid_t group, const char* name, T) {
    h5::Table table = h5::Table::open(f, group, name);
    return table.read<T>(f, 0, table.rows());
  };
  const std::vector<double> rest = all(mesh, "rest_points", double{});
  for (std::size_t i = 0; i + 2 < rest.size(); i += 3) mesh_.points.emplace_back(rest[i], rest[i + 1], rest[i + 2]);
  mesh_.connectivity = all(root, "Connectivity", std::int64_t{});
  mesh_.offsets = all(root, "Offsets", std::int64_t{});
  mesh_.types = all(root, "Types", std::uint8_t{});
  mesh_.body_of_point = all(h5::open_group(f, root, "PointData"), "body_id", std::int32_t{});
  mesh_.body_of_cell = all(h5::open_group(f, root, "CellData"), "body_id", std::int32_t{});
  std::istringstream names(h5::read_text(f, mesh, "body_names"));
  for (std::string name; std::getline(names, name);) mesh_.body_names.push_back(name);

  const std::int64_t count = h5::get_integer(f, steps, "NSteps");
  times_ = h5::Table::open(f, steps, "Values").read<double>(f, 0, static_cast<hsize_t>(count));
}

void FieldReader::check_frame(std::int64_t frame) const {
  if (frame < 0 || frame >= frames()) {
    throw Error(Exit::file, file_.path() + ": there is no frame " + std::to_string(frame) + ", the file holds " + std::to_string(frames()));
  }
}

std::vector<Vec3> FieldReader::points(std::int64_t frame) const {
  check_frame(frame);
  h5::Id root = h5::open_group(file_, file_.id(), "VTKHDF");
  const hsize_t n = mesh_.points.size();
  const auto xyz = h5::Table::open(file_, root, "Points").read<double>(file_, frame * n, n);
  std::vector<Vec3> out(n);
  for (hsize_t i = 0; i < n; ++i) out[i] = {xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]};
  return out;
}

FieldValues FieldReader::field(const std::string& folder, const std::string& name, std::int64_t frame, hsize_t count) const {
  check_frame(frame);
  h5::Id group = h5::open_group(file_, file_.id(), folder);
  if (name.empty() || !h5::exists(file_, group, name)) return {};
  const h5::Table table = h5::Table::open(file_, group, name);
  const hsize_t first = name == "body_id" ? 0 : frame * count;  // the one constant field
  return {table.components(), table.unit(file_), table.read<double>(file_, first, count)};
}

FieldValues FieldReader::point_field(const std::string& name, std::int64_t frame) const {
  return field("VTKHDF/PointData", name, frame, mesh_.points.size());
}

FieldValues FieldReader::cell_field(const std::string& name, std::int64_t frame) const {
  return field("VTKHDF/CellData", name, frame, mesh_.cells());
}

FieldValues FieldReader::rows(const std::string& group, const std::string& name, std::int64_t frame) const {
  check_frame(frame);
  h5::Id effects = h5::open_group(file_, file_.id(), "mortise/effects");
  if (group.empty() || name.empty() || !h5::exists(file_, effects, group)) return {};
  h5::Id owner = h5::open_group(file_, effects, group), index = h5::open_group(file_, owner, "row_offset");
  if (!h5::exists(file_, index, name)) return {};
  const auto ends = h5::Table::open(file_, index, name).read<std::int64_t>(file_, frame, 2);
  const h5::Table table = h5::Table::open(file_, owner, name);
  return {table.components(), table.unit(file_), table.read<double>(file_, ends[0], ends[1] - ends[0])};
}

FieldValues FieldReader::scalar(const std::string& group, const std::string& name, std::int64_t frame) const {
  check_frame(frame);
  h5::Id effects = h5::open_group(file_, file_.id(), "mortise/effects");
  if (group.empty() || name.empty() || !h5::exists(file_, effects, group)) return {};
  h5::Id owner = h5::open_group(file_, effects, group);
  if (!h5::exists(file_, owner, name) || h5::is_group(file_, owner, name)) return {};
  const h5::Table table = h5::Table::open(file_, owner, name);
  return {table.components(), table.unit(file_), table.read<double>(file_, frame, 1)};
}

std::vector<std::string> FieldReader::names(const std::string& folder) const { return h5::members(file_, h5::open_group(file_, file_.id(), folder)); }

std::vector<std::string> FieldReader::point_fields() const { return names("VTKHDF/PointData"); }
std::vector<std::string> FieldReader::cell_fields() const { return names("VTKHDF/CellData"); }

std::vector<std::string> FieldReader::scalars() const {
  std::vector<std::string> out;
  const h5::Id effects = h5::open_group(file_, file_.id(), "mortise/effects");
  for (const std::string& group : h5::members(file_, effects)) {
    const h5::Id owner = h5::open_group(file_, effects, group);
    const bool tables = h5::exists(file_, owner, "row_offset");
    for (const std::string& name : h5::members(file_, owner))
      if (!h5::is_group(file_, owner, name) && !(tables && h5::exists(file_, h5::open_group(file_, owner, "row_offset"), name)))
        out.push_back(group + "/" + name);
  }
  return out;
}

std::vector<StepRow> FieldReader::steps() const {
  h5::Id group = h5::open_group(file_, file_.id(), "mortise/steps");
  std::vector<StepRow> out;
  for (const StepColumn& column : step_columns) {
    const h5::Table table = h5::Table::open(file_, group, column.name);
    const auto values = table.read<double>(file_, 0, table.rows());
    out.resize(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) out[i].*column.value = values[i];
  }
  return out;
}

}  // namespace mortise::output
