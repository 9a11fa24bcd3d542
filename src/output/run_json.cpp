#include "output/run_json.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "output/atomic_file.h"
#include "output/json_number.h"

namespace mortise::output {
namespace {

using Json = nlohmann::ordered_json;

const char* status_of(Exit code) {
  switch (code) {
    case Exit::done:
    case Exit::checks:
      return "done";
    case Exit::stopped:
      return "stopped";
    default:
      return "failed";
  }
}

// Sum, mean and largest of one column over the steps that know it.
Json summary(const std::vector<StepRow>& steps, double StepRow::*column) {
  double total = 0, largest = -INFINITY, smallest = INFINITY;
  int n = 0;
  for (const StepRow& row : steps) {
    const double value = row.*column;
    if (!std::isfinite(value)) continue;
    total += value, largest = std::max(largest, value), smallest = std::min(smallest, value), ++n;
  }
  if (n == 0) return nullptr;
  return {{"total", number_or_null(total)}, {"mean", number_or_null(total / n)}, {"min", number_or_null(smallest)}, {"max", number_or_null(largest)}};
}

std::string utc(std::time_t time) {
  std::tm parts{};
  gmtime_r(&time, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

}  // namespace

std::string run_json(const RunRecord& r) {
  const std::time_t now = std::time(nullptr);
  Json j;
  j["filetype"] = "mortise run";
  j["version"] = {1, 1};
  j["status"] = status_of(r.exit_code);
  j["exit_code"] = static_cast<int>(r.exit_code);
  j["message"] = r.message;
  j["started"] = utc(now - static_cast<std::time_t>(std::llround(r.wall_seconds)));
  j["finished"] = utc(now);
  j["mortise_version"] = r.mortise_version;
  j["git_sha1"] = r.git_sha1;
  j["libraries"] = r.libraries;
  j["hardware"] = {{"cpu", r.hardware.cpu}, {"cores", r.hardware.cores}, {"memory_bytes", r.hardware.memory_bytes}};
  j["device"] = {
      {"kind", r.device.kind},     {"name", r.device.name},       {"threads", r.device.threads},          {"memory_bytes", r.device.memory_bytes},
      {"driver", r.device.driver}, {"runtime", r.device.runtime}, {"architecture", r.device.architecture}};
  j["linear_solver"] = r.linear_solver;
  j["scene"] = {{"name", r.scene_name}, {"path", r.scene_path}, {"sha256", r.scene_sha256}};
  j["command_line"] = r.command_line;
  j["wall_seconds"] = number_or_null(r.wall_seconds);
  j["seconds"] = Json::object();
  for (const auto& [part, seconds] : r.seconds) j["seconds"][part] = number_or_null(seconds);
  j["cpu_seconds"] = Json::object();
  for (const auto& [part, seconds] : r.cpu_seconds) j["cpu_seconds"][part] = number_or_null(seconds);
  j["phases"] = Json::array();
  for (const auto& p : r.phases) {
    j["phases"].push_back({{"effect", p.effect}, {"phase", p.phase}, {"seconds", number_or_null(p.seconds)}, {"calls", p.calls}});
  }
  j["launches"] = Json::object();
  for (const auto& [kernel, count] : r.launches) j["launches"][kernel] = count;
  j["transfers"] = Json::object();
  for (const auto& t : r.transfers)
    j["transfers"][t.of] = {
        {"to_device", t.to_device}, {"bytes_to_device", t.bytes_to_device}, {"to_host", t.to_host}, {"bytes_to_host", t.bytes_to_host}};
  j["waits"] = Json::object();
  for (const auto& [who, count] : r.waits) j["waits"][who] = count;
  j["memory_peak_bytes"] = {{"host", r.host_memory_peak_bytes}, {"device", r.device_memory_peak_bytes}};
  j["frames"] = r.frames;
  Json& steps = j["steps"];
  steps["count"] = r.steps.size();
  for (const StepColumn& column : step_columns) {
    const std::string name = column.name;
    if (name != "step" && name != "time") steps[name] = summary(r.steps, column.value);
  }
  return json_text(j, 2) + "\n";
}

namespace {

// What `get` makes of the file if it is of a run, else R().
template <class R, class Get>
R of_run(const std::string& path, Get get) {
  try {
    const Json j = Json::parse(read_file(path));
    if (j.at("filetype") == "mortise run") return get(j);
  } catch (const Error&) {
  } catch (const Json::exception&) {
  }
  return {};
}

}  // namespace

std::optional<Exit> code_of_finished_run(const std::string& path, const std::string& scene_sha256) {
  return of_run<std::optional<Exit>>(path, [&](const Json& j) {
    const bool this_one = j.at("status") == "done" && j.at("scene").at("sha256") == scene_sha256;
    return this_one ? std::optional(static_cast<Exit>(j.at("exit_code").get<int>())) : std::nullopt;
  });
}

std::string scene_of_run(const std::string& path) {
  return of_run<std::string>(path, [](const Json& j) { return j.at("scene").at("sha256").get<std::string>(); });
}

void write_run_json(const std::string& path, const RunRecord& record) { write_file_atomically(path, run_json(record), true); }

}  // namespace mortise::output
