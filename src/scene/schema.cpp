#include "scene/schema.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "scene/quantity.h"
#include "scene/tables.h"
#include "scene/yaml.h"

namespace mortise::scene {
namespace {

using Kind = Param::Kind;
using Json = nlohmann::ordered_json;

Json block(const ParamTable& t);

Json to_json(const Node& n) {
  switch (n.kind) {
    case Node::Kind::null:
      return nullptr;
    case Node::Kind::list: {
      Json out = Json::array();
      for (const Node& item : n.items) out.push_back(to_json(item));
      return out;
    }
    case Node::Kind::map: {
      Json out = Json::object();
      for (const auto& [key, value] : n.entries) out[key] = to_json(value);
      return out;
    }
    case Node::Kind::scalar:
      break;
  }
  if (!n.quoted && (n.text == "true" || n.text == "false")) return n.text == "true";
  if (!n.quoted && looks_like_quantity(n.text)) {
    const Quantity q = parse_quantity(n.text, Unit::none);
    if (q.error.empty() && q.value == std::floor(q.value) && std::abs(q.value) < 1e15) return static_cast<long long>(q.value);
    if (q.error.empty()) return q.value;
  }
  return n.text;
}

// Number in SI, or text with one of the unit's suffixes.
Json number_schema(const Param& p) {
  Json out = Json::object();
  if (p.unit == Unit::none) {
    out["type"] = "number";
  } else {
    std::string units;
    for (const std::string& s : suffixes(p.unit)) {
      units += units.empty() ? "" : "|";
      for (char c : s) units += c == '^' ? "\\^" : std::string(1, c);
    }
    out["type"] = {"number", "string"};
    out["pattern"] = std::string(p.automatic ? "^auto$|" : "") + "^[-+]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][-+]?[0-9]+)?\\s*(" + units + ")$";
  }
  const auto bound = [](double v) { return v == std::floor(v) ? Json(static_cast<long long>(v)) : Json(v); };
  if (std::isfinite(p.min)) out[p.min_open ? "exclusiveMinimum" : "minimum"] = bound(p.min);
  if (std::isfinite(p.max)) out[p.max_open ? "exclusiveMaximum" : "maximum"] = bound(p.max);
  return out;
}

Json list_of(Json items, int min = 1) { return {{"type", "array"}, {"items", std::move(items)}, {"minItems", min}}; }

Json vec3(const Param& p) {
  Json out = list_of(number_schema(p), 3);
  out["maxItems"] = 3;
  return out;
}

Json described(const Param& p);

Json value(const Param& p) {
  switch (p.kind) {
    case Kind::number:
      return number_schema(p);
    case Kind::integer: {
      Json out = number_schema(p);
      out["type"] = "integer";
      return out;
    }
    case Kind::flag:
      return {{"type", "boolean"}};
    case Kind::text:
    case Kind::path:
      return {{"type", "string"}};
    case Kind::choice:
      return {{"enum", p.choices}};
    case Kind::vec3:
      return vec3(p);
    case Kind::numbers:
      return list_of(number_schema(p));
    case Kind::vec3s:
      return list_of(vec3(p));
    case Kind::names:
      return p.choices.empty() ? list_of({{"type", "string"}}, 0) : list_of({{"enum", p.choices}});
    case Kind::pairs: {
      Json pair = list_of({{"type", "string"}}, 2);
      pair["maxItems"] = 2;
      return list_of(std::move(pair), 0);
    }
    case Kind::schedule: {
      Param time;
      time.unit = Unit::time;
      Json table = {{"type", "object"},
                    {"properties", {{"time", list_of(number_schema(time))}, {"value", list_of(number_schema(p))}}},
                    {"required", {"time", "value"}},
                    {"additionalProperties", false}};
      return {{"oneOf", Json::array({number_schema(p), std::move(table)})}};
    }
    case Kind::table:
      return block(*p.sub);
    case Kind::tables:
      return {{"oneOf", Json::array({block(*p.sub), list_of(block(*p.sub))})}};
    case Kind::map:
      return {{"type", "object"}, {"propertyNames", {{"pattern", "^[a-z0-9_-]+$"}}}, {"additionalProperties", block(*p.sub)}};
  }
  return Json::object();
}

Json described(const Param& p) {
  const std::string symbol = p.unit == Unit::none || p.unit == Unit::any ? "" : si_symbol(p.unit);
  Json out = {{"description", (symbol.empty() ? "" : "[" + symbol + "] ") + p.help}};
  const Json v = value(p);
  for (const auto& [key, item] : v.items())
    if (key != "description") out[key] = item;
  if (p.fallback) out["default"] = to_json(parse_yaml(*p.fallback, ""));
  return out;
}

Json plain_block(const ParamTable& t) {
  Json properties = Json::object(), required = Json::array();
  for (const Param& p : t.params) {
    properties[p.key] = described(p);
    if (!p.fallback && !p.optional) required.push_back(p.key);
  }
  Json out = {{"description", t.help}, {"type", required.empty() ? Json{"object", "null"} : Json("object")}};
  out["properties"] = std::move(properties);
  if (!required.empty()) out["required"] = std::move(required);
  if (t.one_of) {
    out["oneOf"] = Json::array();
    for (const Param& p : t.params) out["oneOf"].push_back({{"required", {p.key}}});
    out["type"] = "object";
  }
  out["patternProperties"] = {{"^x-", Json::object()}};
  out["additionalProperties"] = false;
  return out;
}

Json block(const ParamTable& t) {
  const Variants* variants = variants_of(t);
  if (!variants) return plain_block(t);
  // Which keys are allowed follows from the choice.
  Json out = {{"description", t.help}, {"type", "object"}, {"required", {variants->key}}};
  out["properties"] = {{variants->key, described(t.params.front())}};
  out["allOf"] = Json::array();
  std::vector<std::pair<const ParamTable*, std::vector<std::string>>> tables;  // names by table, in order of appearance
  for (const auto& [name, table] : variants->of) {
    const auto same = std::find_if(tables.begin(), tables.end(), [&, table = table](const auto& t) { return t.first == table; });
    if (same == tables.end())
      tables.push_back({table, {name}});
    else
      same->second.push_back(name);
  }
  for (const auto& [table, names] : tables) {
    const Json choice = names.size() == 1 ? Json{{"const", names[0]}} : Json{{"enum", names}};
    Json then = plain_block(*table);
    then["properties"][variants->key] = Json::object();  // described above
    out["allOf"].push_back({{"if", {{"properties", {{variants->key, choice}}}}}, {"then", then}});
  }
  return out;
}

}  // namespace

std::string schema(std::span<const EffectTable> effects) {
  const SceneTables tables(effects);
  Json out = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "mortise scene"}};
  Json root = block(tables.root());
  root["properties"]["mortise"] = {{"description", "Version of the scene format."}, {"const", kFormatVersion}};
  for (const char* key : {"description", "type"}) out[key] = root[key], root.erase(key);
  // What a robot's file brings need not be said again: beside `robot` blocks may hold only what differs, and the program alone can tell.
  Json beside = Json::object();
  for (const auto& [key, item] : root["properties"].items()) beside[key] = {{"description", item["description"]}};
  for (const char* whole : {"mortise", "robot"}) beside[whole] = root["properties"][whole];
  out["if"] = {{"required", {"robot"}}};
  out["then"] = {{"properties", std::move(beside)},
                 {"required", {"mortise"}},
                 {"patternProperties", root["patternProperties"]},
                 {"additionalProperties", false}};
  out["else"] = std::move(root);
  return json_text(out, 1) + "\n";
}

}  // namespace mortise::scene
