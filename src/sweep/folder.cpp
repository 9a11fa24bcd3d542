// What a sweep leaves in its folder beside the rows' own folders.
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/json_text.h"
#include "engine/effect_tables.h"
#include "output/atomic_file.h"
#include "run/check_start.h"
#include "scene/environments.h"
#include "scene/scene.h"
#include "sweep/sweep.h"

namespace fs = std::filesystem;

namespace mortise::sweep {
namespace {

using Json = nlohmann::ordered_json;

// Of the scene as the first row has it: what the scene's file says, and not where it is. Empty where it cannot be read.
std::string identity(const Sweep& s) {
  try {
    return scene::identity(scene::read_scene(s.scene, s.rows.front().overrides(s.set), engine::effect_tables()).root);
  } catch (const Error&) {
    return "";
  }
}

std::string to_json(const Sweep& s) {
  Json rows = Json::array();
  for (const Row& row : s.rows) {
    Json values = Json::object();
    for (const auto& [path, value] : row.values) values[path] = value;
    rows.push_back(values);
  }
  const Json j{{"filetype", "mortise sweep"}, {"version", {1, 0}},          {"name", s.name}, {"scene", s.scene}, {"set", s.set},
               {"scene_sha256", identity(s)}, {"quantities", s.quantities}, {"rows", rows}};
  return json_text(j, 1) + "\n";
}

}  // namespace

void check_rows(const Sweep& sweep) {
  const auto effects = engine::effect_tables();
  Params first;
  for (std::size_t i = 0; i < sweep.rows.size(); ++i) try {
      const Params scene = scene::read_scene(sweep.scene, sweep.rows[i].overrides(sweep.set), effects).root;
      if (i == 0) first = scene;
    } catch (const Error& e) {
      throw Error(e.code(), sweep.rows_at, fmt::format("row {}: {}", i, e.what()));
    }
  if (sweep.quantities.empty()) return;
  if (scene::environment_count(first) > 0)
    throw Error(Exit::scene, sweep.quantities_at, "quantities: a row of environments has no values of its own; its environments.csv has theirs");
  run::check_reported(first, sweep.quantities, "quantities", sweep.quantities_at);
}

// Many rows may begin at once: whoever is first writes the file, whole, and the others find the same.
void claim_folder(const Sweep& sweep, const std::string& folder) {
  std::error_code ec;
  fs::create_directories(folder, ec);
  if (ec) throw Error(Exit::file, "cannot create '" + folder + "': " + ec.message());
  const std::string path = folder + "/sweep.json", text = to_json(sweep);
  if (!fs::exists(path)) {
    const std::string aside = fmt::format("{}.{}", path, ::getpid());  // of this process alone
    output::write_file(aside, text, true);
    output::rename_file(aside, path);
  }
  if (output::read_file(path) != text)
    throw Error(Exit::usage, "'" + folder + "' holds another sweep (other rows or set values, or a scene that says something else: " + path +
                                 "); use another -o, or remove it");
}

Sweep sweep_in(const std::string& folder) {
  const std::string path = folder + "/sweep.json";
  if (!fs::exists(path)) throw Error(Exit::file, "'" + folder + "' is not the folder of a sweep: it has no sweep.json");
  const Json j = Json::parse(output::read_file(path), nullptr, false);
  if (j.is_discarded() || j.value("filetype", "") != "mortise sweep") throw Error(Exit::file, "'" + path + "' is not a sweep's");
  Sweep out{j["name"], j["scene"], j["set"], j["quantities"], {}};
  for (const auto& values : j["rows"]) {
    Row row;
    for (const auto& [p, value] : values.items()) row.values.emplace_back(p, value);
    out.rows.push_back(std::move(row));
  }
  return out;
}

std::string row_folder(const std::string& folder, std::size_t row) { return fmt::format("{}/{:04}", folder, row); }

std::string ranges(const std::vector<std::size_t>& rows) {
  std::string out;
  for (std::size_t i = 0; i < rows.size();) {
    std::size_t last = i;
    while (last + 1 < rows.size() && rows[last + 1] == rows[last] + 1) ++last;
    out += (out.empty() ? "" : ",") + std::to_string(rows[i]);
    if (last > i) out += (last == i + 1 ? "," : "-") + std::to_string(rows[last]);
    i = last + 1;
  }
  return out;
}

}  // namespace mortise::sweep
