#include "scene/scene.h"

#include <filesystem>
#include <sstream>

#include "base/read_file.h"
#include "scene/checker.h"
#include "scene/cross_check.h"
#include "scene/environments.h"
#include "scene/overrides.h"
#include "scene/quantity.h"
#include "scene/robot.h"
#include "scene/tables.h"
#include "scene/trajectory.h"
#include "scene/written_units.h"
#include "scene/yaml.h"

namespace mortise::scene {
namespace {

namespace fs = std::filesystem;

// Somebody took a robot's file for a scene.
std::string robot_hint(const std::string& text) {
  return text.find("<robot") == std::string::npos && text.find("<mujoco") == std::string::npos
             ? ""
             : "a robot's file becomes a scene by 'mortise import', or stands in one: 'robot: {file: ...}'";
}

// What usually is behind yaml-cpp's messages.
std::string syntax_hint(const std::string& text, const SyntaxError& e) {
  if (const std::string robot = robot_hint(text); !robot.empty()) return robot;
  std::istringstream lines(text);
  std::string line;
  for (int i = 0; i < e.at.line; ++i) std::getline(lines, line);
  const std::size_t tab = line.find_first_not_of(' ');
  if (tab != std::string::npos && line[tab] == '\t') return "YAML is indented with spaces, never with tabs";
  if (e.message.find("end of map flow") != std::string::npos) return "a '{' before this place is not closed, or a ',' is missing";
  if (e.message.find("end of sequence flow") != std::string::npos) return "a '[' before this place is not closed, or a ',' is missing";
  if (e.message.find("end of map") != std::string::npos || e.message.find("illegal map value") != std::string::npos)
    return "check the indentation, and that every key is followed by ': '";
  return "";
}

// Files of studies and sweeps look like scenes, and lie beside them.
void check_kind(const Node& root, Diagnostics& errors) {
  if (root.find("mortise")) return;
  for (const char* kind : {"study", "sweep"})
    if (root.find(std::string("mortise_") + kind))
      errors.add(root.at, std::string("this is the file of a ") + kind + ", not a scene",
                 std::string("'mortise ") + kind + " " + root.at.file + "' runs it");
}

// Another version of the format has other keys: nothing else in the file can be judged.
void check_version(const Node& root, Diagnostics& errors) {
  const Node* version = root.find("mortise");
  check_kind(root, errors);
  if (!errors.empty()) return;
  if (!version) {
    errors.add(root.at, "the scene does not say its format version", "add the line 'mortise: " + std::to_string(kFormatVersion) + "'");
  } else if (version->kind != Node::Kind::scalar || version->quoted || version->text != std::to_string(kFormatVersion)) {
    errors.add(version->at, "format version is " + version->describe() + "; this program reads version " + std::to_string(kFormatVersion));
  }
}

// `environment`: numbers of an environment, which then is a scene of its own; null: the scene as written.
Scene read(const std::string& text, const std::string& path, const std::vector<std::string>& overrides, std::span<const EffectTable> effects,
           const std::vector<Drawn>* environment, const std::string& called) {
  const SceneTables tables(effects);
  Diagnostics errors(text);
  Scene scene{{}, path, text};
  Node root;
  try {
    root = parse_yaml(text, path);
  } catch (const SyntaxError& e) {
    errors.add(e.at, e.message, syntax_hint(text, e));
    errors.raise();
  }
  root.at = root.key_at = {path, 1, 1};
  if (root.kind == Node::Kind::null)
    errors.add(root.at, "the scene is empty");
  else if (root.kind != Node::Kind::map)
    errors.add(root.at, "the scene is " + root.describe() + "; must be a block of keys", robot_hint(text));
  else
    check_version(root, errors);
  if (!errors.empty()) errors.raise();

  // Those of `robot` say what it stands for, all others what is changed of that.
  const auto of_robot = [](const std::string& set) { return set.rfind("robot.", 0) == 0 || set.rfind("robot=", 0) == 0; };
  const std::string folder = fs::absolute(path).parent_path().string();
  for (const std::string& set : overrides)
    if (of_robot(set)) apply_override(root, set, tables.root(), errors);
  expand_robot(root, path, folder, tables.root(), errors);
  if (!errors.empty()) errors.raise();
  for (const std::string& set : overrides)
    if (!of_robot(set)) apply_override(root, set, tables.root(), errors);
  if (environment) {
    std::erase_if(root.entries, [](const auto& entry) { return entry.first == "environments"; });
    for (const Drawn& d : *environment) apply_override(root, d.path + "=" + format_number(d.value), tables.root(), errors, called);
  }
  Checker checker(errors, folder);
  scene.root = checker.table(tables.root(), root, "");
  check_written_units(root, scene.root, errors);
  expand_trajectories(scene.root, errors);
  cross_check(scene.root, effects, checker.incomplete(), errors);
  check_environments(root, scene.root, tables.root(), checker.incomplete(), errors);
  if (!errors.empty()) errors.raise();
  return scene;
}

}  // namespace

double end_time(const Params& root) {
  const Params& time = root.at("time");
  return time.text("mode") == "static" ? 1 : time.number("step") * static_cast<double>(time.integer("steps"));
}

Scene read_scene(const std::string& path, const std::vector<std::string>& overrides, std::span<const EffectTable> effects) {
  Scene scene = read_scene_text(read_stream(path, max_bytes::scene), path == "-" ? "<stdin>" : path, overrides, effects);
  scene.path = path;
  return scene;
}

Scene read_scene_text(const std::string& text, const std::string& path, const std::vector<std::string>& overrides,
                      std::span<const EffectTable> effects) {
  return read(text, path, overrides, effects, nullptr, "");
}

Scene environment_of(const Scene& all, const std::vector<std::string>& overrides, std::span<const EffectTable> effects, long environment,
                     long episode) {
  const std::vector<Drawn> numbers = draw(all.root, environment, episode);
  const std::string called = "environment " + std::to_string(environment) + (episode > 0 ? ", episode " + std::to_string(episode) : "") + ": ";
  Scene scene = read(all.text, all.path == "-" ? "<stdin>" : all.path, overrides, effects, &numbers, called);
  scene.path = all.path;
  return scene;
}

Scene one_environment(const Scene& all, const std::vector<std::string>& overrides, std::span<const EffectTable> effects, long environment,
                      long episode) {
  const long count = environment_count(all.root);
  if (count == 0) throw Error(Exit::usage, "--environment: the scene has no 'environments'");
  if (environment < 0 || environment >= count)
    throw Error(Exit::usage, "--environment " + std::to_string(environment) + ": the scene has " +
                                 (count == 1 ? "one environment, 0" : "environments 0 to " + std::to_string(count - 1)));
  return environment_of(all, overrides, effects, environment, episode);
}

}  // namespace mortise::scene
