#include "run/environment_end.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "base/csv_cell.h"
#include "base/json_text.h"
#include "base/version.h"
#include "output/atomic_file.h"
#include "run/folder.h"
#include "scene/quantity.h"

namespace mortise::run {
namespace {

using Json = nlohmann::ordered_json;

Json read_json(const std::string& path) {
  std::error_code ec;
  return std::filesystem::exists(path, ec) ? Json::parse(output::read_file(path), nullptr, false) : Json();
}

Json text_or_null(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }
std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

std::string name_of(long environment) { return std::filesystem::path(environment_folder("", environment)).filename().string(); }

}  // namespace

void read_run(const std::string& folder, EnvironmentEnd& end) {
  const Json run = read_json(folder + "/run.json"), certificate = read_json(folder + "/certificate.json");
  if (run.is_object() && run.contains("steps") && run.contains("frames")) {
    const Json& steps = run["steps"];
    end.steps += steps.value("count", 0L);
    end.frames += run["frames"].get<long>();
    if (const auto it = steps.find("newton_iterations"); it != steps.end() && it->is_object())
      end.newton += static_cast<long>(it->value("total", 0.0));
  }
  const auto said = [&](const char* key) { return certificate.is_object() ? certificate.value(key, "") : std::string(); };
  if (const std::string grade = said("grade"); grade > end.grade) end.grade = grade, end.reason = said("reason");
  end.grade_forces = std::max(end.grade_forces, said("grade_forces"));
  end.runs.push_back(folder);
}

void read_end(const std::string& folder, EnvironmentEnd& end) {
  std::error_code ec;
  // The first one that a partner drives (bridged.h) lies in the folder itself.
  const bool own = !std::filesystem::exists(episode_folder(folder, 0), ec);
  if (own) read_run(folder, end);
  for (long episode = own ? 1 : 0; std::filesystem::exists(episode_folder(folder, episode), ec); ++episode)
    read_run(episode_folder(folder, episode), end);
}

std::string environments_csv(const std::vector<EnvironmentEnd>& all) {
  std::string out = "environment,status,exit_code,grade,grade_forces,reason,message,episodes,steps,newton_iterations,cpu_seconds,wall_seconds";
  if (!all.empty())
    for (const scene::Drawn& d : all.front().drawn) out += "," + csv_cell(d.path);
  out += "\n";
  for (std::size_t e = 0; e < all.size(); ++e) {
    const EnvironmentEnd& end = all[e];
    out += fmt::format("{},{},{},{},{},{},{},{},{},{},{:.3f},{:.3f}", e, end.status(), end.code < 0 ? "" : std::to_string(end.code),
                       csv_cell(end.grade), csv_cell(end.grade_forces), csv_cell(end.reason), csv_cell(first_line(end.message)), end.runs.size(),
                       end.steps, end.newton, end.cpu, end.wall);
    for (const scene::Drawn& d : end.drawn) out += "," + scene::format_number(d.value);
    out += "\n";
  }
  return out;
}

std::string environments_json(const std::vector<EnvironmentEnd>& all, const BatchEnd& end) {
  const auto count = [&](auto is) { return std::count_if(all.begin(), all.end(), is); };
  Json j;
  j["filetype"] = "mortise environments";
  j["version"] = {1, 0};
  j["mortise_version"] = version();
  j["scene"] = {{"name", end.scene_name}, {"sha256", end.scene_sha256}};
  j["exit_code"] = static_cast<int>(end.code);
  j["message"] = end.message;
  j["count"] = all.size();
  j["seed"] = end.seed;
  j["threads"] = end.threads;
  j["done"] = count([](const EnvironmentEnd& e) { return e.code == static_cast<int>(Exit::done); });
  j["checks_failed"] = count([](const EnvironmentEnd& e) { return e.code == static_cast<int>(Exit::checks); });
  j["failed"] = count([](const EnvironmentEnd& e) { return e.failed(); });
  j["stopped"] = count([](const EnvironmentEnd& e) { return e.stopped(); });
  j["waiting"] = count([](const EnvironmentEnd& e) { return e.code < 0; });
  // The worst certificate speaks for all.
  const EnvironmentEnd* worst = nullptr;
  std::string forces;
  std::map<std::string, long> grades;
  double cpu = 0;
  for (const EnvironmentEnd& e : all) {
    cpu += e.cpu;
    if (e.grade.empty()) continue;
    ++grades[e.grade];
    if (!worst || e.grade > worst->grade) worst = &e;
    forces = std::max(forces, e.grade_forces);
  }
  j["grade"] = worst ? Json(worst->grade) : Json(nullptr);
  j["grade_forces"] = text_or_null(forces);
  j["reason"] = worst ? fmt::format("environment {}: {}", worst - all.data(), worst->reason) : "";
  j["grades"] = grades;
  j["wall_seconds"] = end.wall;
  j["cpu_seconds"] = cpu;
  j["environments"] = Json::array();
  for (std::size_t e = 0; e < all.size(); ++e) {
    const EnvironmentEnd& one = all[e];
    Json values = Json::object(), draws = Json::object();
    for (const scene::Drawn& d : one.drawn) values[d.path] = d.value, draws[d.path] = d.draw;
    j["environments"].push_back({{"environment", e},
                                 {"folder", name_of(static_cast<long>(e))},
                                 {"status", one.status()},
                                 {"exit_code", one.code < 0 ? Json(nullptr) : Json(one.code)},
                                 {"message", one.message},
                                 {"grade", text_or_null(one.grade)},
                                 {"grade_forces", text_or_null(one.grade_forces)},
                                 {"reason", one.reason},
                                 {"episodes", one.runs.size()},
                                 {"steps", one.steps},
                                 {"frames", one.frames},
                                 {"newton_iterations", one.newton},
                                 {"cpu_seconds", one.cpu},
                                 {"wall_seconds", one.wall},
                                 {"memory_peak_bytes", one.memory},
                                 {"draws", draws},
                                 {"values", values}});
  }
  return json_text(j, 1) + "\n";
}

}  // namespace mortise::run
