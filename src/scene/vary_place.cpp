#include "scene/vary_place.h"

#include <algorithm>
#include <map>

#include "scene/checker.h"
#include "scene/suggest.h"
#include "scene/tables.h"

namespace mortise::scene {
namespace {

using Kind = Param::Kind;

const ParamTable& table_of(const ParamTable& base, const Params& block) {
  if (const Variants* variants = variants_of(base))
    for (const auto& [name, table] : variants->of)
      if (const Params* key = block.find(variants->key); key && key->as_text() == name) return *table;
  return base;
}

// Blocks of which every environment has the same.
std::string common(const std::string& block) {
  static const std::map<std::string, std::string> why{{"time", "all environments take the same steps"},
                                                      {"solver", "all environments are solved to the same tolerances"},
                                                      {"output", "all environments write the same files"},
                                                      {"render", "all environments are seen by the same cameras"},
                                                      {"checks", "all environments are judged by the same checks"},
                                                      {"pairs", "all environments have the same pairs"},
                                                      {"environments", "the block says how environments differ"}};
  const auto it = why.find(block);
  return it == why.end() ? "" : it->second;
}

class Finder {
 public:
  Finder(const Params& root, const ParamTable& table, Diagnostics& errors) : root_(root), table_(table), errors_(errors) {}

  Place find(const Params& cited) const {
    Place here{param::table("", &table_, ""), &root_};
    std::string path;
    for (const std::string& part : split_path(cited.as_text())) {
      if (path.empty())
        if (const std::string why = common(part); !why.empty())
          return fail(cited, "'" + part + "' cannot differ between environments: " + why,
                      part == "environments" ? "" : "a sweep can vary it: mortise sweep");
      if (here.value && here.value->kind() == Params::Kind::list) {
        if (!item(here, part, path, cited)) return {};
      } else if (here.param.kind == Kind::map && here.value) {
        const Params* child = here.value->find(part);
        if (!child) return fail(cited, "the scene has no '" + part + "' under " + path, suggestion(part, keys_of(*here.value)));
        here.param.kind = Kind::table, here.value = child;
      } else if (here.param.kind == Kind::table && here.value) {
        if (!key(here, part, path, cited)) return {};
      } else if (here.param.kind == Kind::schedule && here.value && here.value->kind() == Params::Kind::table) {
        const Params* child = here.value->find(part);
        if (!child) return fail(cited, "unknown key '" + part + "' in " + path, suggestion(part, keys_of(*here.value)));
        if (part == "time") here.param.unit = Unit::time;
        here.param.kind = Kind::numbers, here.value = child;
      } else {
        return fail(cited, path + (here.value ? " is a single value; it has no '" + part + "'" : " is not written in the scene"), "");
      }
      path = dotted(path, part);
      if (path.rfind("bodies.", 0) == 0 && part == "shape")
        return fail(cited, path + " cannot differ between environments: all have the same meshes", "a sweep can vary it: mortise sweep");
    }
    return number(here, path, cited);
  }

 private:
  Place fail(const Params& cited, const std::string& what, const std::string& hint) const {
    errors_.add(cited.where(), what, hint);
    return {};
  }
  bool item(Place& here, const std::string& part, const std::string& path, const Params& cited) const {
    const std::size_t n = here.value->items().size();
    const bool digits = !part.empty() && part.size() < 7 && part.find_first_not_of("0123456789") == std::string::npos;
    if (!digits || std::stoul(part) >= n) {
      fail(cited, path + " is a list; its entries are named 0" + (n > 1 ? " to " + std::to_string(n - 1) : ""),
           digits ? "" : "write " + path + ".0." + part);
      return false;
    }
    here.value = &here.value->items()[std::stoul(part)];
    if (here.param.kind == Kind::tables)
      here.param.kind = Kind::table;
    else if (here.param.kind == Kind::vec3s)
      here.param.kind = Kind::vec3;
    else if (here.param.kind == Kind::vec3 || here.param.kind == Kind::numbers)
      here.param.kind = Kind::number;
    else
      here.param.kind = Kind::text;
    return true;
  }
  bool key(Place& here, const std::string& part, const std::string& path, const Params& cited) const {
    const ParamTable& block = table_of(*here.param.sub, *here.value);
    const auto p = std::find_if(block.params.begin(), block.params.end(), [&](const Param& q) { return q.key == part; });
    if (p == block.params.end()) {
      std::vector<std::string> known;
      for (const Param& q : block.params) known.push_back(q.key);
      fail(cited, "unknown key '" + part + "' in " + (path.empty() ? "the scene" : path), suggestion(part, known));
      return false;
    }
    const Params* child = here.value->find(part);
    if (path == "effects" && !child) {
      fail(cited, "the scene does not list the effect '" + part + "'", suggestion(part, keys_of(*here.value)));
      return false;
    }
    here.param = *p, here.value = child;
    return true;
  }
  Place number(Place here, const std::string& path, const Params& cited) const {
    if (here.param.kind == Kind::integer)
      return fail(cited, path + " is a whole number, of which all environments have the same", "only numbers that measure something can differ");
    if (here.param.kind == Kind::schedule && (!here.value || here.value->kind() != Params::Kind::table)) here.param.kind = Kind::number;
    if (here.param.kind == Kind::number) return here.found = true, here;
    if (here.value && here.value->kind() == Params::Kind::list && !here.value->items().empty())
      return fail(cited, path + " is a list; name one of its numbers", "write " + path + ".0");
    if (here.value && here.value->kind() == Params::Kind::table)
      return fail(cited, path + " is a block; name one of its numbers", "it has " + join(keys_of(*here.value), ", "));
    return fail(cited, path + " is no number", "only numbers can differ between environments");
  }

  const Params& root_;
  const ParamTable& table_;
  Diagnostics& errors_;
};

}  // namespace

Place find_place(const Params& cited, const Params& root, const ParamTable& table, Diagnostics& errors) {
  return Finder(root, table, errors).find(cited);
}

std::vector<std::string> split_path(const std::string& path) {
  std::vector<std::string> parts{""};
  for (char c : path)
    if (c == '.')
      parts.emplace_back();
    else
      parts.back() += c;
  return parts;
}

std::vector<std::string> keys_of(const Params& block) {
  std::vector<std::string> out;
  for (const auto& [key, value] : block.entries()) out.push_back(key);
  return out;
}

}  // namespace mortise::scene
