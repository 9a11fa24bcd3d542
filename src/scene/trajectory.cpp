#include "scene/trajectory.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/csv.h"
#include "scene/quantity.h"

namespace mortise::scene {
namespace {

ColumnReader& column_reader() {
  static ColumnReader r;
  return r;
}

// What is wrong at a place of the scene.
struct TrajectoryError {
  SourceLoc at;
  std::string message;
};
TrajectoryError trajectory_error(const Params& key, std::string message) { return {key.where(), std::move(message)}; }

Column column_of(const std::string& path, const Params& name) {
  if (!is_hdf5(path)) {
    const Csv csv = read_csv(path);
    const Csv::Column& c = csv.column(name.as_text());
    return {c.values, c.unit, csv.at(c).text()};
  }
  if (!column_reader()) throw trajectory_error(name, "this program reads no HDF5 files");
  try {
    return column_reader()(path, name.as_text());
  } catch (const Error& e) {
    if (e.code() != Exit::scene) throw;
    throw trajectory_error(name, e.what());
  }
}

// What one of the column's unit is in SI; `key` of the file's block says it where the column does not.
double factor_of(const Column& c, const Params& file, const char* key, Unit unit) {
  const bool said = file.has(key);
  if (!c.unit.empty() && said && c.unit != file.text(key))
    throw trajectory_error(file.at(key), std::string(key) + " is " + file.text(key) + ", but " + c.at + " says " + c.unit);
  const std::string text = !c.unit.empty() ? c.unit : said ? file.text(key) : "";
  if (text.empty())
    throw trajectory_error(
        file, c.at + " has no unit: " + (is_hdf5(file.text("path")) ? "give it an attribute 'unit'" : "write it into the column's name, 'x [mm]'") +
                  ", or give the file's block a '" + key + "'");
  const Quantity one = parse_quantity("1 " + text, unit);
  if (one.error.empty()) return one.value;
  std::string known;
  for (const std::string& s : suffixes(unit)) known += (known.empty() ? "" : ", ") + s;
  throw trajectory_error(said && c.unit.empty() ? file.at(key) : file,
                         c.at + ": '" + text + "' is no unit of " + dimension(unit) + "; there are: " + known);
}

std::vector<double> times_of(const Params& file, std::size_t rows) {
  std::vector<double> out;
  if (file.has("rate")) {
    for (std::size_t i = 0; i < rows; ++i) out.push_back(static_cast<double>(i) / file.number("rate"));
    return out;
  }
  const Column time = column_of(file.text("path"), file.at("time_column"));
  const double unit = factor_of(time, file, "time_unit", Unit::time);
  if (time.values.size() != rows)
    throw trajectory_error(file.at("time_column"),
                           time.at + " has " + std::to_string(time.values.size()) + " rows, other columns have " + std::to_string(rows));
  for (std::size_t i = 0; i < rows; ++i) {
    out.push_back(unit * time.values[i]);
    if (i > 0 && !(out[i] > out[i - 1]))
      throw trajectory_error(file.at("time_column"), time.at + ": times must increase, but row " + std::to_string(i) + " (from 0) is " +
                                                         format_number(time.values[i]) + " after " + format_number(time.values[i - 1]));
  }
  return out;
}

Params number_list(const std::vector<double>& values, double factor, const SourceLoc& at) {
  Params out = Params::make_list({}, at);
  for (double v : values) out.push(Params::make_number(factor * v, at));
  return out;
}

// `block` without `file`, and with what `keys` has.
Params in_place_of_file(const Params& block, const Params& keys) {
  Params out = Params::make_table(block.where());
  for (const auto& [key, value] : block.entries())
    if (key != "file") out.set(key, value);
  for (const auto& [key, value] : keys.entries()) out.set(key, value);
  return out;
}

struct TargetUnit {
  const char* unit;
  Unit measures;
  const char* key;
};
constexpr TargetUnit kTargets[] = {{"rad", Unit::angle, "angle"},    {"deg", Unit::angle, "angle"},   {"m", Unit::length, "travel"},
                                   {"mm", Unit::length, "travel"},   {"N m", Unit::energy, "torque"}, {"Nm", Unit::energy, "torque"},
                                   {"N mm", Unit::energy, "torque"}, {"N", Unit::force, "force"},     {"mN", Unit::force, "force"}};

// {angle: {time: [...], value: [...]}}: the unit says what it is.
Params target_of(const Params& file) {
  const Column c = column_of(file.text("path"), file.at("column"));
  const bool said = file.has("unit");
  if (!c.unit.empty() && said && c.unit != file.text("unit"))
    throw trajectory_error(file.at("unit"), "unit is " + file.text("unit") + ", but " + c.at + " says " + c.unit);
  const std::string unit = !c.unit.empty() ? c.unit : said ? file.text("unit") : "";
  if (unit.empty()) throw trajectory_error(file.at("column"), c.at + " has no unit: give it an attribute 'unit', or the drive's file a 'unit'");
  const auto known = std::find_if(std::begin(kTargets), std::end(kTargets), [&](const TargetUnit& k) { return unit == k.unit; });
  if (known == std::end(kTargets)) {
    std::string all;
    for (const TargetUnit& k : kTargets) all += (all.empty() ? "" : ", ") + std::string(k.unit);
    throw trajectory_error(file.at("column"), c.at + ": '" + unit + "' is no unit of a drive's target; there are: " + all);
  }
  const double factor = unit == "Nm" ? 1 : unit == "N mm" ? 1e-3 : parse_quantity("1 " + unit, known->measures).value;
  Params keys = Params::make_table(file.where());
  keys.set("time", number_list(times_of(file, c.values.size()), 1, file.where()));
  keys.set("value", number_list(c.values, factor, file.where()));
  Params out = Params::make_table(file.where());
  out.set(known->key, std::move(keys));
  return out;
}

// A track of poses p(t), R(t): the body stands in the scene as the first of them says, and goes by p(t) - p(0) while it turns by R(t) R(0)^T about
// p(0), or about `centre`, where the tracked point stands.
Params motion_of(const Params& motion) {
  const Params& file = motion.at("file");
  for (const char* key : {"time", "translation", "rotation", "orientation"})
    if (motion.has(key)) throw trajectory_error(motion.at(key), std::string(key) + " and 'file' both say how the body moves; give one of them");
  const std::string& path = file.text("path");
  const auto columns = [&](const char* key, std::size_t wanted, const char* order) {
    std::vector<Column> out;
    if (!file.has(key)) return out;
    const std::vector<Params>& names = file.at(key).items();
    if (names.size() != wanted)
      throw trajectory_error(file.at(key), std::string(key) + " names " + std::to_string(names.size()) + " columns; it should be " + order);
    for (const Params& name : names) out.push_back(column_of(path, name));
    for (const Column& c : out)
      if (c.values.size() != out[0].values.size())
        throw trajectory_error(
            file.at(key), c.at + " has " + std::to_string(c.values.size()) + " rows, " + out[0].at + " has " + std::to_string(out[0].values.size()));
    return out;
  };
  const std::vector<Column> position = columns("position", 3, "those of x, y and z"), turn = columns("quaternion", 4, "those of w, x, y and z");
  if (position.empty() && turn.empty()) throw trajectory_error(file, "a motion's file needs 'position' or 'quaternion', names of columns");
  const std::size_t rows = (position.empty() ? turn : position)[0].values.size();
  if (!turn.empty() && turn[0].values.size() != rows)
    throw trajectory_error(file.at("quaternion"), turn[0].at + " has " + std::to_string(turn[0].values.size()) + " rows, " + position[0].at +
                                                      " has " + std::to_string(rows));
  Params out = Params::make_table(file.where());
  out.set("time", number_list(times_of(file, rows), 1, file.where()));
  Vec3 first = Vec3::Zero();
  if (!position.empty()) {
    Vec3 unit;
    for (int a = 0; a < 3; ++a) unit[a] = factor_of(position[a], file, "unit", Unit::length), first[a] = unit[a] * position[a].values[0];
    Params way = Params::make_list({}, file.where());
    for (std::size_t i = 0; i < rows; ++i) {
      Params key = Params::make_list({}, file.where());
      for (int a = 0; a < 3; ++a) key.push(Params::make_number(unit[a] * position[a].values[i] - first[a], file.where()));
      way.push(std::move(key));
    }
    out.set("translation", std::move(way));
  }
  if (turn.empty()) return out;
  if (position.empty() && !file.has("centre"))
    throw trajectory_error(file, "a track of orientations alone needs 'centre', the point about which the body turns");
  const Vec3 centre = file.has("centre") ? file.vec3("centre") : first;
  constexpr double kUnit = 1e-3;  // of its norm: digits that files leave out
  std::vector<double> parts[4];
  Eigen::Quaterniond from = Eigen::Quaterniond::Identity();
  for (std::size_t i = 0; i < rows; ++i) {
    const Eigen::Quaterniond q(turn[0].values[i], turn[1].values[i], turn[2].values[i], turn[3].values[i]);
    if (std::abs(q.norm() - 1) > kUnit)
      throw trajectory_error(file.at("quaternion"), "row " + std::to_string(i) + " (from 0) of the quaternion's columns has the norm " +
                                                        format_number(q.norm()) + "; it should be 1 (are they w, x, y, z?)");
    if (i == 0) from = q.normalized();
    const Eigen::Quaterniond by = q.normalized() * from.conjugate();
    parts[0].push_back(by.w()), parts[1].push_back(by.x()), parts[2].push_back(by.y()), parts[3].push_back(by.z());
  }
  Params orientation = Params::make_table(file.where());
  Params at = Params::make_list({}, file.where());
  for (int a = 0; a < 3; ++a) at.push(Params::make_number(centre[a], file.where()));
  orientation.set("centre", std::move(at));
  for (int k = 0; k < 4; ++k) orientation.set(std::string(1, "wxyz"[k]), number_list(parts[k], 1, file.where()));
  out.set("orientation", std::move(orientation));
  return out;
}

}  // namespace

void set_column_reader(ColumnReader r) { column_reader() = std::move(r); }

bool is_hdf5(const std::string& path) {
  std::string end = std::filesystem::path(path).extension().string();
  std::transform(end.begin(), end.end(), end.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return end == ".h5" || end == ".hdf5";
}

void expand_trajectories(Params& root, Diagnostics& errors) {
  const Params* effects = root.find("effects");
  if (!effects) return;
  Params changed = *effects;
  bool any = false;
  const auto expand = [&](const char* effect, const auto& of_entry) {
    const Params* list = effects->find(effect);
    if (!list || list->kind() != Params::Kind::list) return;
    Params out = Params::make_list({}, list->where());
    for (const Params& entry : list->items()) {
      try {
        out.push(of_entry(entry));
      } catch (const TrajectoryError& w) {
        errors.add(w.at, w.message);
        out.push(entry);
      }
    }
    changed.set(effect, std::move(out));
  };
  expand("drive", [&](const Params& entry) {
    const Params* file = entry.find("file");
    if (!file || !file->has("path") || !file->has("column") || !is_hdf5(file->text("path"))) return entry;
    const Params keys = target_of(*file);
    const std::string& key = keys.entries()[0].first;
    if (entry.has(key)) throw trajectory_error(*file, "has keys in '" + key + "' and in 'file'; give one of them");
    any = true;
    return in_place_of_file(entry, keys);
  });
  expand("pin", [&](const Params& entry) {
    const Params* motion = entry.find("motion");
    if (!motion || !motion->has("file") || !motion->at("file").has("path")) return entry;
    Params out = entry;
    out.set("motion", in_place_of_file(*motion, motion_of(*motion)));
    any = true;
    return out;
  });
  if (any) root.set("effects", std::move(changed));
}

}  // namespace mortise::scene
