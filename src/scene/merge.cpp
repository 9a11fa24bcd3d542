#include "scene/merge.h"

#include <algorithm>

#include "scene/tables.h"

namespace mortise::scene {
namespace {

using Kind = Param::Kind;

const Param* param_of(const ParamTable& table, const Node& block, const std::string& key) {
  const ParamTable* t = &table;
  if (const Variants* variants = variants_of(table)) {
    const Node* choice = block.find(variants->key);
    for (const auto& [name, of] : variants->of)
      if (choice && choice->text == name) t = of;
  }
  const auto found = std::find_if(t->params.begin(), t->params.end(), [&](const Param& p) { return p.key == key; });
  return found == t->params.end() ? nullptr : &*found;
}

// A block of which only parts can be replaced: same kind, and of the same variant.
bool alike(const Node& under, const Node& over, const ParamTable& table) {
  if (under.kind != Node::Kind::map || over.kind != Node::Kind::map || table.one_of) return false;
  const Variants* variants = variants_of(table);
  const Node *a = variants ? under.find(variants->key) : nullptr, *b = variants ? over.find(variants->key) : nullptr;
  return !a || !b || a->text == b->text;
}

void put(Node& under, const Node& over, const ParamTable& table) {
  if (alike(under, over, table))
    merge(under, over, table);
  else
    under = over;
}

// What an entry of a list is called.
const Node* called(const Node& entry) {
  for (const char* key : {"name", "joint"})
    if (const Node* n = entry.find(key)) return n;
  return nullptr;
}

void put_list(Node& under, const Node& over, const ParamTable& table) {
  const std::vector<Node> entries = over.kind == Node::Kind::list ? over.items : std::vector<Node>{over};  // a single block stands for a list of one
  for (const Node& entry : entries) {
    const Node* name = entry.kind == Node::Kind::map ? called(entry) : nullptr;
    const auto same = std::find_if(under.items.begin(), under.items.end(), [&](const Node& n) {
      const Node* other = n.kind == Node::Kind::map ? called(n) : nullptr;
      return name && other && other->text == name->text;
    });
    if (same == under.items.end())
      under.items.push_back(entry);
    else
      put(*same, entry, table);
  }
}

}  // namespace

void merge(Node& under, const Node& over, const ParamTable& table) {
  for (const auto& [key, value] : over.entries) {
    Node* there = under.find(key);
    if (!there) {
      under.entries.emplace_back(key, value);
      continue;
    }
    const Param* p = param_of(table, under, key);
    if (p && p->kind == Kind::table) {
      put(*there, value, *p->sub);
    } else if (p && p->kind == Kind::map && there->kind == Node::Kind::map && value.kind == Node::Kind::map) {
      for (const auto& [name, block] : value.entries) {
        if (Node* known = there->find(name))
          put(*known, block, *p->sub);
        else
          there->entries.emplace_back(name, block);
      }
    } else if (p && p->kind == Kind::tables && there->kind == Node::Kind::list && (value.kind == Node::Kind::list || value.kind == Node::Kind::map)) {
      put_list(*there, value, *p->sub);
    } else {
      *there = value;
    }
  }
}

}  // namespace mortise::scene
