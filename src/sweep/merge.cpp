#include "sweep/merge.h"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/csv_cell.h"
#include "base/error.h"
#include "output/atomic_file.h"
#include "output/field_reader.h"
#include "output/h5.h"
#include "scene/suggest.h"

namespace fs = std::filesystem;

namespace mortise::sweep {
namespace {

using Json = nlohmann::ordered_json;

Json read_json(const std::string& path) { return fs::exists(path) ? Json::parse(output::read_file(path), nullptr, false) : Json(); }

double number(const Json& j, const char* block, const char* key) {
  if (!j.is_object() || !j.contains(block) || !j[block].is_object()) return NAN;
  const auto it = j[block].find(key);
  return it != j[block].end() && it->is_number() ? it->get<double>() : NAN;
}

// A row of a scene with several environments: their sum stands for a certificate, and there is no one last value of a scalar.
bool of_environments(const std::string& folder) { return fs::exists(folder + "/environments.json"); }

// Of the quantities those that this row, which has ended, does not have.
std::vector<std::string> unknown(const std::string& folder, const std::vector<std::string>& quantities) {
  std::vector<std::string> out;
  if (of_environments(folder) || !fs::exists(folder + "/fields.vtkhdf")) return out;
  const std::vector<std::string> there = output::FieldReader(folder + "/fields.vtkhdf").scalars();
  for (const std::string& q : quantities) {
    if (std::find(there.begin(), there.end(), q) != there.end()) continue;
    const std::string near = scene::suggestion(q, there);
    out.push_back(fmt::format("no scalar '{}' in {}/fields.vtkhdf{}{}", q, folder, near.empty() ? "" : "; ", near));
  }
  return out;
}

// The last values of the scalars; NaN where there are none.
std::vector<double> at_the_end(const std::string& folder, const std::vector<std::string>& quantities) {
  std::vector<double> out(quantities.size(), NAN);
  if (quantities.empty() || of_environments(folder) || !fs::exists(folder + "/fields.vtkhdf")) return out;
  const output::FieldReader file(folder + "/fields.vtkhdf");
  if (file.frames() == 0) return out;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t slash = quantities[i].find('/');
    const output::FieldValues v = file.scalar(quantities[i].substr(0, slash), quantities[i].substr(slash + 1), file.frames() - 1);
    if (v.components == 1) out[i] = v.values[0];
  }
  return out;
}

std::string line(const Sweep& sweep, std::size_t row, const std::string& folder, const Status& status) {
  std::string out = std::to_string(row);
  for (const auto& [path, value] : sweep.rows[row].values) out += "," + csv_cell(value);
  const Json run = read_json(folder + "/run.json"),
             certificate = read_json(folder + (of_environments(folder) ? "/environments.json" : "/certificate.json"));
  const auto text = [&](const char* key) {
    return certificate.is_object() && certificate.contains(key) && certificate[key].is_string() ? certificate[key].get<std::string>() : "";
  };
  out += fmt::format(",{},{},{},{},{}", name_of(status.is), status.code >= 0 ? std::to_string(status.code) : "", csv_cell(text("grade")),
                     csv_cell(text("grade_forces")), csv_cell(status.is == Status::Is::failed ? status.message : text("reason")));
  out += "," + csv_cell(number(certificate, "solver", "steps")) + "," + csv_cell(number(certificate, "solver", "newton_iterations_mean")) + "," +
         csv_cell(number(run, "seconds", "solve"));
  for (double v : at_the_end(folder, sweep.quantities)) out += "," + csv_cell(v);
  return out + "\n";
}

std::string header(const Sweep& sweep) {
  std::string out = "row";
  if (!sweep.rows.empty())
    for (const auto& [path, value] : sweep.rows.front().values) out += "," + csv_cell(path);
  out += ",status,exit_code,grade,grade_forces,reason,steps,newton_iterations_mean,solve_seconds";
  for (const std::string& q : sweep.quantities) out += "," + csv_cell(q);
  return out + "\n";
}

// No values are copied: a link holds a file name, relative to this file.
void link_fields(const std::string& folder, const std::vector<std::string>& rows) {
  output::h5::File file(folder + "/fields.h5", output::h5::Mode::create);
  for (const std::string& row : rows)
    file.check(H5Lcreate_external((row + "/fields.vtkhdf").c_str(), "/", file.id(), row.c_str(), H5P_DEFAULT, H5P_DEFAULT), "link " + row);
  file.close();
}

}  // namespace

std::vector<std::size_t> Merged::with(Status::Is is) const {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i].is == is) out.push_back(i);
  return out;
}

Merged merge(const std::string& folder) {
  const Sweep sweep = sweep_in(folder);
  Merged out;
  std::string table = header(sweep);
  std::vector<std::string> linked;
  for (std::size_t i = 0; i < sweep.rows.size(); ++i) {
    const std::string row = row_folder(folder, i);
    out.rows.push_back(status_of(row));
    table += line(sweep, i, row, out.rows.back());
    if (out.unknown.empty() && out.rows.back().finished()) out.unknown = unknown(row, sweep.quantities);
    if (fs::exists(row + "/fields.vtkhdf")) linked.push_back(fs::path(row).filename().string());
  }
  out.table = folder + "/table.csv";
  output::write_file_atomically(out.table, table, false);
  link_fields(folder, linked);
  return out;
}

}  // namespace mortise::sweep
