#include "study/read.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "base/read_file.h"
#include "bench/benchmark.h"
#include "scene/checker.h"
#include "scene/flow.h"
#include "scene/quantity.h"
#include "scene/suggest.h"
#include "scene/yaml.h"
#include "study/limit.h"

namespace mortise::study {
namespace {

using scene::Diagnostics;
using scene::Node;
namespace fs = std::filesystem;

using Keys = std::vector<std::string>;
const Keys kKeys{"mortise_study", "name",    "scene",      "benchmark",     "set",    "plan",
                 "ladders",       "methods", "quantities", "over_resolved", "repeat", "limit"};

// Unknown and doubled keys; false where `node` is no block.
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

// A list of texts; one text stands for a list of one.
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

double seconds(const Node& node, const std::string& what, Diagnostics& errors) {
  const scene::Quantity q = scene::parse_quantity(node.text, Unit::time);
  if (node.kind == Node::Kind::scalar && q.error.empty() && q.value > 0) return q.value;
  errors.add(node.at, what + " is " + node.describe() + "; must be a time > 0, e.g. 60 s");
  return 0;
}

// Settings of `PATH: value`.
Settings settings(const Node& node, const std::string& what, Diagnostics& errors) {
  Settings out;
  if (node.kind != Node::Kind::map || node.entries.empty())
    return errors.add(node.at, what + " is " + node.describe() + "; must be a block of PATH: value"), out;
  for (const auto& [path, value] : node.entries) out.emplace_back(path, scene::flow(value));
  return out;
}

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

Quantity quantity(const Node& node, const std::string& what, scene::Checker& checker, Diagnostics& errors) {
  Quantity out;
  out.place = node.at;
  if (node.kind == Node::Kind::scalar) return out.name = out.value = node.text, out;
  const Params p = checker.table(quantity_table(), node, what);
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
  const bool field = !out.value.empty() && out.value.find('/') == std::string::npos;
  if (field && out.body.empty())
    errors.add(node.at, what + ": '" + out.value + "' is a field of points and needs a body; scalars are written group/name");
  if (!field && !out.body.empty()) errors.add(node.at, what + ": '" + out.value + "' is a scalar; body belongs to fields of points");
  if (field && !out.body.empty() && out.over.empty() == !out.point) errors.add(node.at, what + " needs either over or point");
  if ((out.over == "percentile") != std::isfinite(out.percent)) errors.add(node.at, what + ": percentile and percent belong together");
  if (out.at && node.find("when")) errors.add(node.find("when")->key_at, what + " has when and at; write one of them");
  if (out.uncertainty > 0 && !out.reference) errors.add(node.at, what + " has an uncertainty but no reference");
  return out;
}

}  // namespace

bool is_study(const std::string& path) {
  if (path == "-" || !fs::is_regular_file(path)) return false;
  try {
    return scene::parse_yaml(read_regular_file(path, most_bytes::scene), path).find("mortise_study") != nullptr;
  } catch (const scene::SyntaxError&) {
    return false;
  }
}

Study read_study(const std::string& path) {
  const std::string text = read_regular_file(path, most_bytes::scene);
  Diagnostics errors(text);
  const Node root = scene::parse_yaml(text, path);
  const std::string folder = fs::absolute(path).parent_path().string();
  Study out;
  out.name = fs::path(path).stem().string();
  if (!strict(root, "a study", kKeys, errors)) errors.raise();
  if (const Node* version = root.find("mortise_study"); version->text != "1") errors.add(version->at, "this program reads studies of version 1");
  if (const Node* name = root.find("name")) {
    out.name = name->text;
    if (!scene::is_name(out.name)) errors.add(name->at, "name is '" + name->text + "'; names are made of a-z, 0-9, _ and -");
  }
  const Node *file = root.find("scene"), *benchmark = root.find("benchmark");
  if (!file == !benchmark) {
    errors.add(benchmark ? benchmark->key_at : SourceLoc{path, 1, 1}, "a study needs either 'scene: FILE' or 'benchmark: NAME'");
  } else if (file) {
    out.scene = (fs::path(folder) / file->text).lexically_normal().string();
    if (!fs::is_regular_file(out.scene)) errors.add(file->at, "there is no scene '" + out.scene + "'", "paths start at the folder of the study");
  } else {
    Keys names;
    for (const bench::Benchmark& b : bench::benchmarks()) names.emplace_back(b.name);
    out.benchmark = benchmark->text;
    if (!bench::find_benchmark(out.benchmark))
      errors.add(benchmark->at, "there is no benchmark '" + out.benchmark + "'", scene::suggestion(out.benchmark, names));
  }
  out.set = texts(root.find("set"), "set", errors);
  out.one_at_a_time = true;
  if (const Node* plan = root.find("plan")) {
    out.one_at_a_time = plan->text == "one_at_a_time";
    if (!out.one_at_a_time && plan->text != "combinations")
      errors.add(plan->at, "plan is " + plan->describe() + "; must be one_at_a_time or combinations");
  }
  const auto list = [&](const char* key, bool needed, const char* what) {
    const Node* n = root.find(key);
    if (needed && (!n || n->kind != Node::Kind::list || n->items.empty()))
      errors.add(n ? n->at : SourceLoc{path, 1, 1}, fmt::format("a study needs '{}:', a list of {}", key, what));
    if (n && !needed && n->kind != Node::Kind::list) errors.add(n->at, fmt::format("{} is {}; must be a list of {}", key, n->describe(), what));
    return n && n->kind == Node::Kind::list ? n->items : std::vector<Node>{};
  };
  for (const Node& n : list("ladders", false, "ladders")) out.ladders.push_back(ladder(n, out.ladders.size(), errors));
  for (const Node& n : list("methods", false, "methods")) out.methods.push_back(method(n, out.methods.size(), errors));
  scene::Checker checker(errors, folder);
  for (const Node& n : list("quantities", true, "quantities"))
    out.quantities.push_back(quantity(n, fmt::format("quantities.{}", out.quantities.size()), checker, errors));
  std::set<std::string> names;
  for (const Quantity& q : out.quantities)
    if (!q.name.empty() && !names.insert(q.name).second) errors.add(q.place, "two quantities are called '" + q.name + "'", "give them names");
  for (const Method& m : out.methods)
    if (!names.insert("method " + m.name).second) errors.add(m.at, "two methods are called '" + m.name + "'");
  if (const Node* over = root.find("over_resolved")) out.over_resolved = settings(*over, "over_resolved", errors), out.over_resolved_at = over->at;
  if (const Node* limit = root.find("limit")) out.limit = seconds(*limit, "limit", errors);
  if (const Node* repeat = root.find("repeat")) {
    out.repeats = repeat->text.size() < 4 && repeat->text.find_first_not_of("0123456789") == std::string::npos && !repeat->text.empty()
                      ? std::stoi(repeat->text)
                      : 0;
    if (out.repeats < 1) errors.add(repeat->at, "repeat is " + repeat->describe() + "; must be a whole number from 1");
  }
  if (!errors.empty()) errors.raise();
  return out;
}

Ladder ladder_of_flag(const std::string& text) {
  const std::size_t eq = text.find('=');
  if (eq == std::string::npos || eq == 0 || eq + 1 == text.size()) throw Error(Exit::usage, "--vary " + text + ": write key=value1,value2,...");
  std::vector<std::string> values{""};
  int depth = 0;
  for (char c : text.substr(eq + 1)) {
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (c == ',' && depth == 0)
      values.emplace_back();
    else
      values.back() += c;
  }
  Ladder out{text.substr(0, eq), {}, ladder_sizes(values), {"--vary " + text, 0, 0}};
  for (const std::string& v : values) {
    if (v.empty()) throw Error(Exit::usage, "--vary " + text + ": a value is empty");
    out.steps.push_back({{{out.name, v}}, v});
  }
  if (const std::string why = not_a_ladder(values); !why.empty()) throw Error(Exit::usage, "--vary " + text + ": " + why);
  return out;
}

Quantity quantity_of_flag(const std::string& text) {
  const SourceLoc at{"--qoi " + text, 0, 0};
  if (text.empty() || text[0] != '{') {
    Quantity out;
    out.name = out.value = text, out.place = at;
    return out;
  }
  Diagnostics errors("");
  scene::Checker checker(errors, "");
  Quantity out;
  try {
    Node node = scene::parse_yaml(text, "", &at);
    node.at = node.key_at = at;
    out = quantity(node, "quantity", checker, errors);
  } catch (const scene::SyntaxError& e) {
    errors.add(at, e.message);
  }
  if (!errors.empty()) errors.raise();
  return out;
}

}  // namespace mortise::study
