#include "run/reported.h"

#include <algorithm>
#include <vector>

#include "base/error.h"
#include "effects/roles.h"
#include "scene/suggest.h"

namespace mortise::run {

bool may_report(const std::string& scalar, const Params& scene, const Snapshot& start) {
  if (start.has(scalar)) return true;
  if (scalar.find('/') == std::string::npos) return false;
  // Forces of ties and motors, and of balances, are those of a step.
  const std::string group = group_of(scalar);
  using effects::Role;
  const bool later = effects::has_role(group, Role::tie) || effects::has_role(group, Role::motor);
  return group == "supports" || group == "balance" || group == "audit" || (later && scene.at("effects").has(group));
}

void not_reported(const SourceLoc& where, const std::string& what, const std::string& scalar, const Snapshot& said) {
  std::vector<std::string> known;
  for (const auto& [name, number] : said.number) known.push_back(name);
  const std::string hint = scene::suggestion(scalar, known);
  throw Error(Exit::scene, where, what + ": nothing reports '" + scalar + "'" + (hint.empty() ? "" : "; " + hint));
}

void check_quantities(const Params& scene, const Snapshot& start) {
  const Params* list = scene.find("quantities");
  for (std::size_t i = 0; list && i < list->items().size(); ++i) {
    const Params& q = list->items()[i];
    const std::string &value = q.text("value"), what = "quantities." + std::to_string(i);
    if (value.find('/') == std::string::npos || group_of(value) == "steps") continue;
    if (start.row.count(value) && !start.has(value + "_x"))
      throw Error(Exit::scene, q.where(), what + ": '" + value + "' is a table, of which a run has one per frame; a quantity is a scalar");
    if (!may_report(value, scene, start)) not_reported(q.where(), what, value, start);
  }
}

}  // namespace mortise::run
