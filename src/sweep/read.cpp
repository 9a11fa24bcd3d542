#include <algorithm>
#include <filesystem>
#include <tuple>

#include "base/read_file.h"
#include "scene/diagnostics.h"
#include "scene/suggest.h"
#include "scene/yaml.h"
#include "sweep/blocks.h"
#include "sweep/sweep.h"

namespace mortise::sweep {
namespace {

using scene::Diagnostics;
using scene::Node;
namespace fs = std::filesystem;

const std::vector<std::string> kKeys{"mortise_sweep", "name", "scene", "set", "quantities", "rows"};

// A list of texts; one text stands for a list of one.
std::vector<std::string> texts(const Node& node, const std::string& key, Diagnostics& errors) {
  std::vector<std::string> out;
  const auto collect = [&](const Node& n) {
    if (n.kind == Node::Kind::scalar)
      out.push_back(n.text);
    else
      errors.add(n.at, key + " has " + n.describe() + "; must be text");
  };
  if (node.kind == Node::Kind::list)
    for (const Node& n : node.items) collect(n);
  else
    collect(node);
  return out;
}

// Every combination, the last block's rows fastest.
std::vector<Row> combined(const std::vector<std::vector<Row>>& blocks) {
  std::vector<Row> out{{}};
  for (const std::vector<Row>& block : blocks) {
    std::vector<Row> next;
    for (const Row& one : out)
      for (const Row& other : block) {
        next.push_back(one);
        next.back().values.insert(next.back().values.end(), other.values.begin(), other.values.end());
      }
    out = std::move(next);
  }
  return out;
}

void no_path_twice(const std::vector<std::vector<Row>>& blocks, const Node& at, Diagnostics& errors) {
  std::vector<std::string> seen;
  for (const std::vector<Row>& block : blocks) {
    if (block.empty()) continue;
    for (const auto& [path, value] : block.front().values) {
      if (std::count(seen.begin(), seen.end(), path)) errors.add(at.at, "rows: '" + path + "' is varied by two blocks");
      seen.push_back(path);
    }
  }
}

}  // namespace

Sweep read_sweep(const std::string& path) {
  const std::string text = read_regular_file(path, max_bytes::scene);
  Diagnostics errors(text);
  Node root;
  try {
    root = scene::parse_yaml(text, path);
  } catch (const scene::SyntaxError& e) {
    errors.add(e.at, e.message);
    errors.raise();
  }
  const std::string folder = fs::absolute(path).parent_path().string();
  Sweep out;
  out.name = fs::path(path).stem().string();
  if (root.kind != Node::Kind::map) {
    errors.add({path, 1, 1}, "a sweep is a block of keys (" + scene::join(kKeys, ", ") + ")");
    errors.raise();
  }
  for (const auto& [mark, what, command] : {std::tuple("mortise", "a scene", "run"), std::tuple("mortise_study", "the file of a study", "study")})
    if (root.find(mark) && !root.find("mortise_sweep")) {
      errors.add({path, 1, 1}, std::string("this is ") + what + ", not the file of a sweep",
                 std::string("'mortise ") + command + " " + path + "' runs it");
      errors.raise();
    }
  for (const auto& [key, node] : root.entries)
    if (!key.starts_with("x-") && !std::count(kKeys.begin(), kKeys.end(), key))
      errors.add(node.key_at, "unknown key '" + key + "' in a sweep", scene::suggestion(key, kKeys));
  const Node* version = root.find("mortise_sweep");
  if (!version || version->text != "1") errors.add(version ? version->at : SourceLoc{path, 1, 1}, "a sweep begins with 'mortise_sweep: 1'");
  if (const Node* name = root.find("name")) out.name = name->text;
  if (const Node* file = root.find("scene")) {
    out.scene = (fs::path(folder) / file->text).lexically_normal().string();
    if (!fs::exists(out.scene)) errors.add(file->at, "there is no scene '" + out.scene + "'");
  } else {
    errors.add({path, 1, 1}, "a sweep needs 'scene: FILE'");
  }
  if (const Node* set = root.find("set")) out.set = texts(*set, "set", errors);
  if (const Node* quantities = root.find("quantities")) out.quantities = texts(*quantities, "quantities", errors), out.quantities_at = quantities->at;
  for (const std::string& q : out.quantities)
    if (q.find('/') == std::string::npos)
      errors.add(out.quantities_at, "quantity '" + q + "' is not of the form group/name, e.g. mortar_contact/force_pad_z");
  const Node* rows = root.find("rows");
  if (!rows || rows->kind != Node::Kind::list || rows->items.empty()) {
    errors.add(rows ? rows->at : SourceLoc{path, 1, 1}, "a sweep needs 'rows:', a list of blocks (" + scene::join(block_names(), ", ") + ")");
    errors.raise();
  }
  out.rows_at = rows->at;
  std::vector<std::vector<Row>> blocks;
  for (const Node& block : rows->items) blocks.push_back(rows_of_block(block, folder, errors));
  no_path_twice(blocks, *rows, errors);
  if (!errors.empty()) errors.raise();
  double count = 1;
  for (const auto& block : blocks) count *= static_cast<double>(block.size());
  constexpr double kMostRows = 1e6;
  if (count > kMostRows) errors.add(rows->at, "that is more than a million rows"), errors.raise();
  out.rows = combined(blocks);
  return out;
}

std::vector<std::string> Row::overrides(const std::vector<std::string>& of_all) const {
  std::vector<std::string> out = of_all;
  for (const auto& [path, value] : values) out.push_back(path + "=" + value);
  return out;
}

}  // namespace mortise::sweep
