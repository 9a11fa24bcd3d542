#include "effects/contact/named.h"

#include <algorithm>

namespace mortise::effects::contact {
namespace {

void add_names(const Params& p, std::set<std::string>& names) {
  if (p.kind() == Params::Kind::text) names.insert(p.as_text());
  if (p.kind() == Params::Kind::list)
    for (const Params& item : p.items()) add_names(item, names);
  if (p.kind() == Params::Kind::table)
    for (const auto& [key, value] : p.entries()) add_names(value, names);
}

}  // namespace

std::set<std::string> named(const Params& pairs) {
  std::set<std::string> out;
  add_names(pairs, out);
  return out;
}

bool pass(const Params& scene, const std::string& a, const std::string& b) {
  const Params* list = scene.find("pairs");
  if (!list || list->kind() != Params::Kind::list) return false;
  return std::any_of(list->items().begin(), list->items().end(), [&](const Params& pair) {
    if (pair.flag("collide")) return false;
    const std::set<std::string> names = named(pair.at("bodies"));
    return names.count(a) > 0 && names.count(b) > 0;
  });
}

}  // namespace mortise::effects::contact
