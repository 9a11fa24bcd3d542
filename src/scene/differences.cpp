#include "scene/differences.h"

#include <algorithm>

#include "scene/flow.h"

namespace mortise::scene {
namespace {

constexpr std::size_t kShown = 60;  // characters of a value: what fits on a line twice

std::string shown(const Node* n) {
  if (!n) return "missing";
  const std::string text = flow(*n);
  return text.size() <= kShown ? text : text.substr(0, kShown - 3) + "...";
}

bool has_parts(const Node& n) {
  return n.kind == Node::Kind::map || (n.kind == Node::Kind::list && !n.items.empty() && n.items[0].kind == Node::Kind::map);
}

void walk(const std::string& path, const Node* there, const Node* here, std::vector<std::string>& out) {
  if (there && here && there->kind == here->kind && has_parts(*there) && has_parts(*here)) {
    const std::string prefix = path.empty() ? "" : path + ".";
    if (here->kind == Node::Kind::map) {
      for (const auto& [key, value] : here->entries) walk(prefix + key, there->find(key), &value, out);
      for (const auto& [key, value] : there->entries)
        if (!here->find(key)) walk(prefix + key, &value, nullptr, out);
    } else {
      const auto item = [](const Node& list, std::size_t i) { return i < list.items.size() ? &list.items[i] : nullptr; };
      for (std::size_t i = 0; i < std::max(there->items.size(), here->items.size()); ++i)
        walk(prefix + std::to_string(i), item(*there, i), item(*here, i), out);
    }
  } else if (!there || !here || flow(*there) != flow(*here)) {
    out.push_back(path + " is " + shown(there) + " there and " + shown(here) + " here");
  }
}

}  // namespace

std::vector<std::string> differences(const std::string& there, const std::string& here) {
  try {
    std::vector<std::string> out;
    const Node a = parse_yaml(there, "there"), b = parse_yaml(here, "here");
    walk("", &a, &b, out);
    return out;
  } catch (const SyntaxError& e) {
    throw Error(Exit::file, e.at, e.message);
  }
}

}  // namespace mortise::scene
