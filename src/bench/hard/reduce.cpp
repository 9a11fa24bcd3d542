// Scenes that failed, made smaller for as long as they fail in the same way.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>

#include "bench/hard/dice.h"
#include "bench/hard/hard.h"

namespace fs = std::filesystem;

namespace mortise::bench::hard {
namespace {

void forget_body(YAML::Node scene, const std::string& name) {
  scene["bodies"].remove(name);
  const auto keep = [&](YAML::Node list, const char* key) {
    YAML::Node out(YAML::NodeType::Sequence);
    for (const auto& item : list)
      if (item[key].as<std::string>() != name && !(item["master"] && item["master"].as<std::string>() == name)) out.push_back(item);
    return out;
  };
  YAML::Node effects = scene["effects"];
  if (effects["pin"]) effects["pin"] = keep(effects["pin"], "body");
  if (effects["pin"] && effects["pin"].size() == 0) effects.remove("pin");
  if (effects["mortar_contact"]) effects["mortar_contact"]["pairs"] = keep(effects["mortar_contact"]["pairs"], "slave");
}

// Smaller scenes to try, each a little less than the one given.
std::vector<YAML::Node> smaller(const YAML::Node& scene) {
  std::vector<YAML::Node> out;
  const auto with = [&](const std::function<void(YAML::Node)>& change) {
    YAML::Node copy = YAML::Clone(scene);
    change(copy);
    out.push_back(copy);
  };
  for (const auto& body : scene["bodies"]) {
    const std::string name = body.first.as<std::string>();
    if (scene["bodies"].size() > 1) with([&](YAML::Node s) { forget_body(s, name); });
    for (const char* key : {"rotation", "velocity", "angular_velocity", "self_contact"})
      if (body.second[key]) with([&](YAML::Node s) { s["bodies"][name].remove(key); });
  }
  for (const char* effect : {"friction", "pin", "gravity"})
    if (scene["effects"][effect]) with([&](YAML::Node s) { s["effects"].remove(effect); });
  const long steps = scene["time"]["steps"].as<long>();
  if (steps > 1) with([&](YAML::Node s) { s["time"]["steps"] = (steps + 1) / 2; }), with([&](YAML::Node s) { s["time"]["steps"] = steps - 1; });
  return out;
}

}  // namespace

std::string reduce(const Case& failed, const Row& row, const Options& options) {
  YAML::Node scene = YAML::Load(failed.text);
  const std::string kind = cause(row);
  Case trial = failed;
  trial.variant = "smaller";
  double left = std::clamp(20 * row.seconds, 5.0, 30.0);  // seconds to spend
  for (bool found = true; found && left > 0;) {
    found = false;
    for (const YAML::Node& candidate : smaller(scene)) {
      if (left <= 0) break;
      trial.text = emit(candidate);
      const Row r = run_case(trial, options);
      left -= r.seconds;
      if (r.pass || cause(r) != kind) continue;
      scene = candidate, found = true;
      break;
    }
  }
  const std::string path = fs::absolute(options.output).string() + "/" + failed.name + ".smallest.yaml";
  std::ofstream(path) << "# " << row.reason << "\n" << emit(scene);
  return path;
}

}  // namespace mortise::bench::hard
