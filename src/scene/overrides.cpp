#include "scene/overrides.h"

#include <algorithm>

#include "base/path_parts.h"
#include "scene/checker.h"
#include "scene/suggest.h"
#include "scene/tables.h"

namespace mortise::scene {
namespace {

using Kind = Param::Kind;

// The table that describes this block as written: a body by its type.
const ParamTable& table_of(const ParamTable& base, const Node& node) {
  if (const Variants* variants = variants_of(base)) {
    const Node* key = node.find(variants->key);
    for (const auto& [name, table] : variants->of)
      if (key && key->text == name) return *table;
  }
  return base;
}

bool is_word(const std::string& part) { return !part.empty() && part.find_first_not_of("-+.0123456789") != std::string::npos; }

std::vector<std::string> keys(const Node& n) {
  std::vector<std::string> out;
  for (const auto& [key, value] : n.entries) out.push_back(key);
  return out;
}

class Override {
 public:
  Override(const std::string& text, const std::string& called, Diagnostics& errors) : at_{called + text, 0, 0}, errors_(errors) {}

  void apply(Node& root, const std::string& path, const std::string& value, const ParamTable& table) {
    Node node;
    try {
      node = parse_yaml(value, "", &at_);
    } catch (const SyntaxError&) {
      errors_.add(at_, "the value '" + value + "' is not valid YAML");
      return;
    }
    node.at = node.key_at = at_;
    parts_ = path_parts(path);
    if (node.kind == Node::Kind::null) {
      if (value.find_first_not_of(' ') == std::string::npos)
        errors_.add(at_, "no value stands behind the '='", "PATH=null removes what the scene has there");
      else
        remove(root);
      return;
    }
    if (Node* place = find(root, table)) {
      if (place->at.line > 0 || place->at.file != at_.file) errors_.replaces(at_.file, place->at);
      *place = std::move(node);
    }
  }

 private:
  // Out of the scene as written: what has a default has that again.
  void remove(Node& root) {
    Node* node = &root;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const std::string& part = parts_[i];
      const bool last = i + 1 == parts_.size();
      if (node->kind == Node::Kind::list) {
        const bool number = !part.empty() && part.size() < 7 && part.find_first_not_of("0123456789") == std::string::npos;
        if (const std::size_t k = number ? std::stoul(part) : node->items.size(); k < node->items.size()) {
          if (last) node->items.erase(node->items.begin() + static_cast<std::ptrdiff_t>(k));
          if (!last) node = &node->items[k];
          continue;
        }
      } else if (Node* found = node->find(part)) {
        if (last) std::erase_if(node->entries, [&](const auto& entry) { return entry.first == part; });
        if (!last) node = found;
        continue;
      }
      errors_.add(at_, "the scene has no '" + part + "' there, which could be removed", suggestion(part, keys(*node)));
      return;
    }
  }

  // The value that the path names, made if need be; null after an error.
  Node* find(Node& root, const ParamTable& root_table) {
    Node* node = &root;
    Param here = param::table("", &root_table, "");  // what `node` is
    std::string path;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const bool last = i + 1 == parts_.size();
      const std::string& part = parts_[i];
      if (node->kind == Node::Kind::null && here.sub) node->kind = Node::Kind::map;

      if (here.kind == Kind::tables && node->kind == Node::Kind::map) {  // a single block stands for a list of one
        Node item = *node;
        node->kind = Node::Kind::list, node->entries.clear(), node->items = {std::move(item)};
      }
      if (node->kind == Node::Kind::list) {
        node = item(*node, here, part, path);
        if (!node) return nullptr;
        if (here.kind == Kind::tables) here.kind = Kind::table;
        if (here.kind == Kind::vec3s) here.kind = Kind::vec3;
      } else if (here.kind == Kind::map) {
        node = last ? added(*node, part) : named(*node, part, "'" + part + "' under " + path);
        if (!node) return nullptr;
        here.kind = Kind::table;
      } else if (here.kind == Kind::table && here.sub) {
        const ParamTable& table = table_of(*here.sub, *node);
        const auto p = std::find_if(table.params.begin(), table.params.end(), [&](const Param& q) { return q.key == part; });
        if (p == table.params.end()) return unknown(part, path, table);
        here = *p;
        if (path == "effects" && !last && !node->find(part)) {
          errors_.add(at_, "the scene does not list the effect '" + part + "'", "to add it: --set 'effects." + part + "={}'");
          return nullptr;
        }
        node = child(*node, part, *p, last);
      } else if (here.kind == Kind::schedule && node->kind == Node::Kind::map) {
        node = named(*node, part, "'" + part + "' under " + path);
        if (!node) return nullptr;
      } else {
        errors_.add(at_, path + " is a single value; it has no '" + part + "'");
        return nullptr;
      }
      path = dotted(path, part);
    }
    return node;
  }

  // A part of a value that the file leaves to its default is a part of the default.
  Node* child(Node& block, const std::string& key, const Param& param, bool last) {
    if (Node* found = block.find(key)) return found;
    Node fresh;
    if (!last && param.fallback) fresh = parse_yaml(*param.fallback, "", &at_);
    fresh.at = fresh.key_at = at_;
    block.entries.emplace_back(key, fresh);
    return &block.entries.back().second;
  }
  // A block with a name of its own (a body, a material) may be new when it is given whole.
  Node* added(Node& block, const std::string& key) {
    if (Node* found = block.find(key)) return found;
    Node fresh;
    fresh.at = fresh.key_at = at_;
    block.entries.emplace_back(key, fresh);
    return &block.entries.back().second;
  }
  Node* named(Node& block, const std::string& key, const std::string& what) {
    if (Node* found = block.find(key)) return found;
    const std::string near = suggestion(key, keys(block));
    errors_.add(at_, "the scene does not have " + what, near.empty() ? "to add it, give it whole: --set 'PATH={...}'" : near);
    return nullptr;
  }
  Node* item(Node& list, const Param& what, const std::string& part, const std::string& path) {
    const std::size_t n = list.items.size();
    if (part.empty() || part.size() > 6 || part.find_first_not_of("0123456789") != std::string::npos) {
      const bool blocks = what.kind == Kind::tables;
      errors_.add(at_, path + " is a list; its entries are named 0" + (n > 1 ? " to " + std::to_string(n - 1) : ""),
                  "write " + path + ".0" + (blocks && is_word(part) ? "." + part : ""));
      return nullptr;
    }
    const std::size_t i = std::stoul(part);
    if (i < n) return &list.items[i];
    errors_.add(at_, path + " has no entry " + part + "; it has " + std::to_string(n) + (n == 1 ? " entry, 0" : " entries, from 0"));
    return nullptr;
  }
  Node* unknown(const std::string& part, const std::string& path, const ParamTable& table) {
    std::vector<std::string> known;
    for (const Param& p : table.params) known.push_back(p.key);
    errors_.add(at_, "unknown key '" + part + "' in " + (path.empty() ? "the scene" : path), suggestion(part, known));
    return nullptr;
  }

  SourceLoc at_;
  Diagnostics& errors_;
  std::vector<std::string> parts_;
};

}  // namespace

void apply_override(Node& root, const std::string& text, const ParamTable& table, Diagnostics& errors, const std::string& called) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw Error(Exit::usage, "--set '" + text + "' is not of the form path=value, for example --set time.steps=10");
  Override(text, called, errors).apply(root, text.substr(0, equals), text.substr(equals + 1), table);
}

}  // namespace mortise::scene
