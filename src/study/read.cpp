#include "study/read.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "base/read_file.h"
#include "bench/benchmark.h"
#include "scene/quantity.h"
#include "scene/suggest.h"
#include "study/limit.h"
#include "study/read_parts.h"

namespace mortise::study {
namespace {

using scene::Diagnostics;
using scene::Node;
namespace fs = std::filesystem;

const Keys kKeys{"mortise_study", "name",    "scene",      "benchmark",     "set",    "plan",
                 "ladders",       "methods", "quantities", "over_resolved", "repeat", "limit"};

double seconds(const Node& node, const std::string& what, Diagnostics& errors) {
  const scene::Quantity q = scene::parse_quantity(node.text, Unit::time);
  if (node.kind == Node::Kind::scalar && q.error.empty() && q.value > 0) return q.value;
  errors.add(node.at, what + " is " + node.describe() + "; must be a time > 0, e.g. 60 s");
  return 0;
}

}  // namespace

bool is_study(const std::string& path) {
  if (path == "-" || !fs::is_regular_file(path)) return false;
  try {
    return scene::parse_yaml(read_regular_file(path, max_bytes::scene), path).find("mortise_study") != nullptr;
  } catch (const scene::SyntaxError&) {
    return false;
  }
}

Study read_study(const std::string& path) {
  const std::string text = read_regular_file(path, max_bytes::scene);
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
