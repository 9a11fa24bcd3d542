#include "study/read_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "scene/flow.h"
#include "scene/quantities.h"
#include "scene/suggest.h"
#include "study/limit.h"
#include "study/read.h"

namespace mortise::study {

using scene::Diagnostics;
using scene::Node;

namespace {

void sizes_of(Ladder& ladder, const Node& node, Diagnostics& errors) {
  std::vector<std::string> first;
  const auto column = [&](std::size_t k) {
    std::vector<std::string> v;
    for (const Ladder::Step& s : ladder.steps) v.push_back(s.settings[k].second);
    return v;
  };
  if (const Node* given = node.find("sizes")) {
    std::vector<std::string> v;
    for (const Node& n : given->items) v.push_back(scene::flow(n));
    ladder.sizes = ladder_sizes(v);
    if (v.size() != ladder.steps.size())
      errors.add(given->at, fmt::format("sizes has {} entries, the ladder has {} steps", v.size(), ladder.steps.size()));
    else if (ladder.sizes.empty() || any_number(v.front()) < any_number(v.back()))
      errors.add(given->at, "sizes must be positive numbers that fall from step to step");
    return;
  }
  for (std::size_t k = 0; k < ladder.steps.front().settings.size() && ladder.sizes.empty(); ++k) {
    if (const std::string why = not_a_ladder(column(k)); !why.empty()) return errors.add(ladder.at, "ladder '" + ladder.name + "': " + why);
    ladder.sizes = ladder_sizes(column(k));
  }
}

}  // namespace

bool strict(const Node& node, const std::string& what, const Keys& known, Diagnostics& errors) {
  if (node.kind != Node::Kind::map)
    return errors.add(node.at, what + " is " + node.describe() + "; must be a block of keys", scene::join(known, ", ")), false;
  std::set<std::string> seen;
  for (const auto& [key, value] : node.entries) {
    if (scene::is_private_key(key)) continue;
    if (!std::count(known.begin(), known.end(), key)) errors.add(value.key_at, "unknown key '" + key + "' in " + what, scene::suggestion(key, known));
    if (!seen.insert(key).second) errors.add(value.key_at, "'" + key + "' appears twice in " + what);
  }
  return true;
}

std::vector<std::string> texts(const Node* node, const std::string& what, Diagnostics& errors) {
  std::vector<std::string> out;
  if (!node) return out;
  const auto take = [&](const Node& n) {
    if (n.kind == Node::Kind::scalar && !n.text.empty())
      out.push_back(n.text);
    else
      errors.add(n.at, what + " has " + n.describe() + "; must be text");
  };
  if (node->kind == Node::Kind::list)
    for (const Node& n : node->items) take(n);
  else
    take(*node);
  return out;
}

Settings settings(const Node& node, const std::string& what, Diagnostics& errors) {
  Settings out;
  if (node.kind != Node::Kind::map || node.entries.empty())
    return errors.add(node.at, what + " is " + node.describe() + "; must be a block of PATH: value"), out;
  for (const auto& [path, value] : node.entries) out.emplace_back(path, scene::flow(value));
  return out;
}

Ladder ladder(const Node& node, std::size_t number, Diagnostics& errors) {
  const std::string what = fmt::format("ladders.{}", number);
  Ladder out;
  out.at = node.at;
  if (!strict(node, what, {"name", "knob", "values", "knobs", "sizes"}, errors)) return out;
  std::vector<std::pair<std::string, const Node*>> columns;
  const Node *knob = node.find("knob"), *values = node.find("values"), *knobs = node.find("knobs");
  if (knobs && (knob || values)) return errors.add(knobs->key_at, what + " has knobs beside knob and values; write one of them"), out;
  if (knobs && knobs->kind == Node::Kind::map && !knobs->entries.empty()) {
    for (const auto& [path, list] : knobs->entries) columns.emplace_back(path, &list);
  } else if (knob && values) {
    columns.emplace_back(knob->text, values);
  } else {
    return errors.add(node.at, what + " varies nothing",
                      "write {knob: PATH, values: [...]}, or {knobs: {PATH: [...], PATH: [...]}} for what moves together"),
           out;
  }
  out.name = columns.front().first;
  if (const Node* name = node.find("name")) out.name = name->text;
  for (const auto& [path, list] : columns) {
    if (list->kind != Node::Kind::list || list->items.empty())
      return errors.add(list->at, what + ": the values of " + path + " are " + list->describe() + "; must be a list"), out;
    if (out.steps.empty()) out.steps.resize(list->items.size());
    if (list->items.size() != out.steps.size())
      return errors.add(list->at,
                        fmt::format("{}: {} has {} values, {} has {}", what, path, list->items.size(), columns.front().first, out.steps.size())),
             Ladder{};
    for (std::size_t i = 0; i < out.steps.size(); ++i) {
      out.steps[i].settings.emplace_back(path, scene::flow(list->items[i]));
      if (out.steps[i].label.empty()) out.steps[i].label = scene::flow(list->items[i]);
    }
  }
  sizes_of(out, node, errors);
  return out;
}

Method method(const Node& node, std::size_t number, Diagnostics& errors) {
  const std::string what = fmt::format("methods.{}", number);
  Method out;
  out.at = node.at;
  if (!strict(node, what, {"name", "without", "set"}, errors)) return out;
  if (const Node* name = node.find("name"))
    out.name = name->text;
  else
    errors.add(node.at, what + " has no name");
  out.without = texts(node.find("without"), what + ".without", errors);
  out.set = texts(node.find("set"), what + ".set", errors);
  return out;
}

// Of a block that was checked.
Quantity quantity_from(const Params& p) {
  Quantity out;
  out.place = p.where();
  const auto text = [&](const char* key, std::string& to) {
    if (const Params* v = p.find(key)) to = v->as_text();
  };
  const auto number = [&](const char* key) { return p.find(key) ? std::optional<double>(p.number(key)) : std::nullopt; };
  text("value", out.value), text("axis", out.axis), text("body", out.body), text("over", out.over), text("when", out.when);
  out.name = out.value;
  if (!out.body.empty()) out.name += " of " + out.body;
  if (!out.over.empty()) out.name = out.over + " of " + out.name;
  if (!out.axis.empty()) out.name += " (" + out.axis + ")";
  out.percent = number("percent").value_or(NAN), out.at = number("at"), out.reference = number("reference");
  out.uncertainty = number("uncertainty").value_or(0), out.scale = number("scale").value_or(0);
  if (const Params* point = p.find("point")) out.point = point->as_vec3();
  if (out.at) out.name += fmt::format(" at {:g} s", *out.at);
  if (!out.at && out.when != "end") out.name = out.when + " of " + out.name;
  text("name", out.name);
  return out;
}

Quantity quantity(const Node& node, const std::string& what, scene::Checker& checker, Diagnostics& errors) {
  if (node.kind == Node::Kind::scalar) {
    Quantity out;
    out.place = node.at;
    return out.name = out.value = node.text, out;
  }
  const Params p = checker.table(scene::quantity_table(), node, what);
  Quantity out = quantity_from(p);
  out.place = node.at;
  scene::check_quantity(p, node.at, what, errors);
  if (out.at && node.find("when")) errors.add(node.find("when")->key_at, what + " has when and at; write one of them");
  return out;
}

std::vector<Quantity> quantities_of(const Params& scene) {
  std::vector<Quantity> out;
  if (const Params* list = scene.find("quantities"))
    for (const Params& q : list->items()) out.push_back(quantity_from(q));
  return out;
}

}  // namespace mortise::study
