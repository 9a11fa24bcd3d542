#include "effects/drive/target.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "base/csv.h"

namespace mortise::effects::drive {
namespace {

using param::of;
using param::optional;

const ParamTable kSine{"drive sine",
                       "Amplitude times sin(2 pi frequency t + phase), added to the keys.",
                       {optional(of(Param::Kind::number, "angle", Unit::angle, std::nullopt, "Amplitude of an angle.")),
                        optional(of(Param::Kind::number, "travel", Unit::length, std::nullopt, "Amplitude of a travel.")),
                        optional(of(Param::Kind::number, "force", Unit::force, std::nullopt, "Amplitude of a force.")),
                        optional(of(Param::Kind::number, "torque", Unit::torque, std::nullopt, "Amplitude of a torque.")),
                        param::positive(param::required(param::number("frequency", Unit::frequency, "", 0, "Frequency."))),
                        of(Param::Kind::number, "phase", Unit::angle, "0", "Phase at t = 0.")}};

const ParamTable kFile{"drive file",
                       "Keys from a column of a table: comma-separated numbers, whose first line names the columns, or HDF5 (.h5, .hdf5).",
                       {param::required(of(Param::Kind::path, "path", Unit::none, std::nullopt, "The file.")),
                        param::required(of(Param::Kind::text, "column", Unit::none, std::nullopt,
                                           "Name of the column; of HDF5 a dataset, demo_0/hip, or a column of one, demo_0/actions[3].")),
                        of(Param::Kind::text, "time_column", Unit::none, "time", "Name of the column of times, which increase from line to line."),
                        param::positive(optional(of(Param::Kind::number, "rate", Unit::none, std::nullopt,
                                                    "Rows per second, in the place of a column of times [Hz]; the first is at t = 0."))),
                        optional(param::choice("unit", {"rad", "deg", "m", "mm", "N m", "N mm", "N", "mN"}, "",
                                               "Unit of the column, where its name has none in brackets.")),
                        optional(param::choice("time_unit", {"s", "ms"}, "", "Unit of the times, where their name has none in brackets."))}};

struct Known {
  const char* text;
  Quantity what;
  double factor;
};
constexpr Known kUnits[] = {{"rad", Quantity::angle, 1},      {"deg", Quantity::angle, std::numbers::pi / 180},
                            {"N m", Quantity::torque, 1},     {"Nm", Quantity::torque, 1},
                            {"N mm", Quantity::torque, 1e-3}, {"m", Quantity::travel, 1},
                            {"mm", Quantity::travel, 1e-3},   {"N", Quantity::force, 1},
                            {"mN", Quantity::force, 1e-3}};
constexpr std::pair<const char*, Quantity> kKeys[] = {
    {"angle", Quantity::angle}, {"travel", Quantity::travel}, {"torque", Quantity::torque}, {"force", Quantity::force}};
const char* key_of(Quantity what) { return kKeys[static_cast<int>(what)].first; }

// The unit of a column: in its name, or in the scene.
std::string unit_of(const Csv& csv, const Csv::Column& c, const Params& file, const char* key) {
  if (!c.unit.empty() && file.has(key) && c.unit != file.text(key))
    throw Error(Exit::scene, file.at(key).where(), std::string(key) + " is " + file.text(key) + ", but " + csv.at(c).text() + " says " + c.unit);
  if (!c.unit.empty()) return c.unit;
  if (!file.has(key))
    throw Error(Exit::scene, csv.at(c),
                "column '" + c.name + "' has no unit: write '" + c.name + (std::string(key) == "unit" ? " [deg]'" : " [s]'") +
                    ", or give the drive's file a '" + key + "'");
  return file.text(key);
}

Params keys_of(const Params& file, Quantity what) {
  const Csv csv = read_csv(file.text("path"));
  const double period = file.has("rate") ? 1 / file.number("rate") : 0;
  const Csv::Column &value = csv.column(file.text("column")), &time = period > 0 ? value : csv.column(file.text("time_column"));
  const std::string time_unit = period > 0 ? "s" : unit_of(csv, time, file, "time_unit"), unit = unit_of(csv, value, file, "unit");
  if (time_unit != "s" && time_unit != "ms") throw Error(Exit::scene, csv.at(time), "'" + time_unit + "' is no unit of time; use s or ms");
  double factor = 0;
  std::string known;
  for (const Known& k : kUnits) {
    if (k.what != what) continue;
    known += (known.empty() ? "" : ", ") + std::string(k.text);
    if (unit == k.text) factor = k.factor;
  }
  if (factor == 0) throw Error(Exit::scene, csv.at(value), "'" + unit + "' is no unit of this drive's " + key_of(what) + "; there are: " + known);
  Params times = Params::make_list(), values = Params::make_list();
  for (std::size_t i = 0; i < csv.lines.size(); ++i) {
    if (period == 0 && i > 0 && !(time.values[i] > time.values[i - 1]))
      throw Error(Exit::scene, SourceLoc{csv.path, csv.lines[i], 1}, "times must increase from line to line");
    times.push(Params::make_number(period > 0 ? period * static_cast<double>(i) : time.values[i] * (time_unit == "ms" ? 1e-3 : 1)));
    values.push(Params::make_number(value.values[i] * factor));
  }
  Params out = Params::make_table();
  out.set("time", std::move(times));
  out.set("value", std::move(values));
  return out;
}

}  // namespace

std::vector<Param> target_params() {
  return {optional(of(Param::Kind::schedule, "angle", Unit::angle, std::nullopt,
                      "Target of a drive of mode pd or kinematic, over time (pseudo-time 0 to 1 in static scenes).")),
          optional(of(Param::Kind::schedule, "travel", Unit::length, std::nullopt, "The same of a prismatic joint.")),
          optional(of(Param::Kind::schedule, "torque", Unit::torque, std::nullopt, "Torque of a drive of mode effort, over time.")),
          optional(of(Param::Kind::schedule, "force", Unit::force, std::nullopt, "Force of a drive of mode effort on a prismatic joint, over time.")),
          param::table("file", &kFile, "Target from a file."),
          param::table("sine", &kSine, "An oscillation about the target."),
          param::table("gait", &gait_table, "Steps of a leg: the target of one of its two hinges."),
          param::choice("interpolation", {"linear", "smooth"}, "linear",
                        "Between keys: linear, or by a cubic that starts and ends at rest and never overshoots a key.")};
}

bool Target::any(const Params& entry) {
  for (const char* key : {"angle", "travel", "torque", "force", "file", "sine", "gait"})
    if (entry.has(key)) return true;
  return false;
}

Target::Target(const Params& entry, Quantity what) {
  const char* mine = key_of(what);
  const std::string mode = entry.text("mode"),
                    needs = std::string(" has no meaning: of this joint a drive of mode ") + mode + " aims at '" + mine + "'";
  for (const auto& [other, of_other] : kKeys)
    if (of_other != what && entry.has(other)) throw Error(Exit::scene, entry.at(other).where(), other + needs);
  if (!any(entry))
    throw Error(
        Exit::scene, entry.where(),
        "a drive of mode " + mode + " needs a target: '" + mine + "', 'file'" + (what == Quantity::angle ? ", 'sine' or 'gait'" : " or 'sine'"));
  if (entry.has(mine) && entry.has("file"))
    throw Error(Exit::scene, entry.at("file").where(), std::string("has keys in '") + mine + "' and in 'file'; give one of them");
  if (entry.has("gait")) {
    if (what != Quantity::angle) throw Error(Exit::scene, entry.at("gait").where(), "gait" + needs + "; it turns hinges");
    for (const char* other : {"angle", "file", "sine"})
      if (entry.has(other))
        throw Error(Exit::scene, entry.at(other).where(),
                    std::string("a drive with a gait aims where that says: '") + other + "' has no place beside it");
    return;
  }
  const bool smooth = entry.text("interpolation") == "smooth";
  if (entry.has(mine)) keys_ = Schedule(entry.at(mine), smooth);
  if (const Params* file = entry.find("file")) keys_ = Schedule(keys_of(*file, what), smooth);
  if (const Params* sine = entry.find("sine")) {
    for (const auto& [other, of_other] : kKeys)
      if (of_other != what && sine->has(other)) throw Error(Exit::scene, sine->at(other).where(), other + needs);
    if (!sine->has(mine))
      throw Error(Exit::scene, sine->where(), std::string("the sine of a drive of mode ") + mode + " needs '" + mine + "', its amplitude");
    amplitude_ = sine->number(mine);
    omega_ = 2 * std::numbers::pi * sine->number("frequency");
    phase_ = sine->number("phase");
  }
}

}  // namespace mortise::effects::drive
