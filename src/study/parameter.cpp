#include "study/parameter.h"

#include <fmt/format.h>

#include <cmath>

#include "scene/quantity.h"
#include "scene/suggest.h"

namespace mortise::study {
namespace {

using Kind = Params::Kind;

bool is_numbers(const Params& p) {
  if (p.kind() == Kind::number) return true;
  if (p.kind() != Kind::list || p.items().empty()) return false;
  for (const Params& item : p.items())
    if (!is_numbers(item)) return false;
  return true;
}

bool is_zero(const Params& p) {
  if (p.kind() == Kind::number) return p.as_number() == 0;
  for (const Params& item : p.items())
    if (!is_zero(item)) return false;
  return true;
}

std::string text_of(const Params& p, double factor) {
  if (p.kind() == Kind::number) return scene::format_number(factor * p.as_number());
  std::string out;
  for (const Params& item : p.items()) out += (out.empty() ? "[" : ", ") + text_of(item, factor);
  return out + "]";
}

// {time: [...], value: [...]}
bool is_schedule(const Params& p) { return p.kind() == Kind::table && p.has("time") && p.has("value") && is_numbers(p.at("value")); }

std::vector<std::string> children(const Params& p) {
  std::vector<std::string> out;
  if (p.kind() == Kind::table)
    for (const auto& [key, value] : p.entries()) out.push_back(key);
  if (p.kind() == Kind::list)
    for (std::size_t i = 0; i < p.items().size(); ++i) out.push_back(std::to_string(i));
  return out;
}

const Params* child(const Params& p, const std::string& key) {
  if (p.kind() == Kind::table) return p.find(key);
  if (p.kind() == Kind::list)
    for (std::size_t i = 0; i < p.items().size(); ++i)
      if (std::to_string(i) == key) return &p.items()[i];
  return nullptr;
}

void collect(const Params& p, const std::string& path, std::vector<Parameter>& out) {
  if (p.kind() == Kind::number && !is_zero(p)) out.push_back({path, p});
  if (is_schedule(p)) {
    if (!is_zero(p.at("value"))) out.push_back({path + ".value", p.at("value")});
  } else if (!is_numbers(p)) {
    for (const std::string& key : children(p)) collect(*child(p, key), path + "." + key, out);
  }
}

}  // namespace

double Parameter::number() const { return value.kind() == Kind::number ? value.as_number() : NAN; }
std::string Parameter::scaled(double factor) const { return path + "=" + text_of(value, factor); }

Parameter parameter(const Params& scene, const std::string& path, const SourceLoc& at) {
  const Params* here = &scene;
  std::string so_far;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t dot = std::min(path.find('.', begin), path.size());
    const std::string key = path.substr(begin, dot - begin);
    const Params* next = child(*here, key);
    if (!next) {
      const std::string hint = scene::suggestion(key, children(*here));
      throw Error(Exit::usage, at,
                  fmt::format("the scene has no '{}'{}{}", key, so_far.empty() ? "" : " under " + so_far, hint.empty() ? "" : "\n  " + hint));
    }
    here = next, so_far = path.substr(0, dot), begin = dot + 1;
  }
  Parameter out{path, *here};
  if (is_schedule(*here)) out = {path + ".value", here->at("value")};
  if (!is_numbers(out.value))
    throw Error(Exit::usage, at,
                fmt::format("'{}' is {}: derivatives are with respect to numbers{}", path,
                            here->kind() == Kind::integer ? "a count" : (here->kind() == Kind::table ? "a block" : "no number"),
                            here->kind() == Kind::table ? "; it has " + scene::join(children(*here), ", ") : ""));
  if (is_zero(out.value)) throw Error(Exit::usage, at, fmt::format("'{}' is 0, of which no share can be changed", path));
  return out;
}

std::vector<Parameter> all_parameters(const Params& scene) {
  std::vector<Parameter> out;
  for (const char* block : {"materials", "effects"})
    if (const Params* p = scene.find(block)) collect(*p, block, out);
  return out;
}

}  // namespace mortise::study
