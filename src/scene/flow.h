#pragma once
#include <string>

#include "scene/yaml.h"

namespace mortise::scene {

// A value as --set takes it: YAML on one line.
inline std::string flow(const Node& n) {
  std::string out;
  if (n.kind == Node::Kind::list) {
    for (const Node& i : n.items) out += (out.empty() ? "" : ", ") + flow(i);
    return "[" + out + "]";
  }
  if (n.kind == Node::Kind::map) {
    for (const auto& [key, value] : n.entries) out += (out.empty() ? "" : ", ") + key + ": " + flow(value);
    return "{" + out + "}";
  }
  if (!n.quoted) return n.text;
  for (char c : n.text) out += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return "\"" + out + "\"";
}

}  // namespace mortise::scene
