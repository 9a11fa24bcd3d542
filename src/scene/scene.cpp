#include "scene/scene.h"

#include <filesystem>
#include <sstream>

#include "base/read_file.h"
#include "scene/checker.h"
#include "scene/cross_check.h"
#include "scene/overrides.h"
#include "scene/tables.h"
#include "scene/yaml.h"

namespace mortise::scene {
namespace {

namespace fs = std::filesystem;

// What usually is behind yaml-cpp's messages.
std::string syntax_hint(const std::string& text, const SyntaxError& e) {
  std::istringstream lines(text);
  std::string line;
  for (int i = 0; i < e.at.line; ++i) std::getline(lines, line);
  const std::size_t tab = line.find_first_not_of(' ');
  if (tab != std::string::npos && line[tab] == '\t') return "YAML is indented with spaces, never with tabs";
  if (e.message.find("end of map flow") != std::string::npos) return "a '{' before this place is not closed, or a ',' is missing";
  if (e.message.find("end of sequence flow") != std::string::npos)
    return "a '[' before this place is not closed, or a ',' is missing";
  if (e.message.find("end of map") != std::string::npos || e.message.find("illegal map value") != std::string::npos)
    return "check the indentation, and that every key is followed by ': '";
  return "";
}

// Another version of the format has other keys: nothing else in the file can be judged.
void check_version(const Node& root, Diagnostics& errors) {
  const Node* version = root.find("mortise");
  if (!version) {
    errors.add(root.at, "the scene does not say its format version",
               "add the line 'mortise: " + std::to_string(kFormatVersion) + "'");
  } else if (version->kind != Node::Kind::scalar || version->quoted || version->text != std::to_string(kFormatVersion)) {
    errors.add(version->at,
               "format version is " + version->describe() + "; this program reads version " + std::to_string(kFormatVersion));
  }
}

}  // namespace

Scene read_scene(const std::string& path, const std::vector<std::string>& overrides, std::span<const EffectTable> effects) {
  Scene scene = read_scene_text(read_stream(path, most_bytes::scene), path == "-" ? "<stdin>" : path, overrides, effects);
  scene.path = path;
  return scene;
}

Scene read_scene_text(const std::string& text, const std::string& path, const std::vector<std::string>& overrides,
                      std::span<const EffectTable> effects) {
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
  if (root.kind == Node::Kind::null) errors.add(root.at, "the scene is empty");
  else if (root.kind != Node::Kind::map) errors.add(root.at, "the scene is " + root.describe() + "; must be a block of keys");
  else check_version(root, errors);
  if (!errors.empty()) errors.raise();

  for (const std::string& set : overrides) apply_override(root, set, tables.root(), errors);
  Checker checker(errors, fs::absolute(path).parent_path().string());
  scene.root = checker.table(tables.root(), root, "");
  cross_check(scene.root, effects, checker.incomplete(), errors);
  if (!errors.empty()) errors.raise();
  return scene;
}

}  // namespace mortise::scene
