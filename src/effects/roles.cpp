#include "effects/roles.h"

#include "effects/list.h"

namespace mortise::effects {

bool has_role(std::string_view name, Role role) {
  const Kind* kind = find_kind(name);
  return kind && kind->role == role;
}

std::vector<std::string> of_role(const Params& effects, Role role) {
  std::vector<std::string> out;
  for (const auto& [name, block] : effects.entries())
    if (has_role(name, role)) out.push_back(name);
  return out;
}

std::vector<const Params*> of_body(const Params& effects, Role role, std::string_view body) {
  std::vector<const Params*> out;
  for (const std::string& name : of_role(effects, role))
    for (const Params& p : effects.at(name).items())
      if (p.has("body") && p.text("body") == body) out.push_back(&p);
  return out;
}

}  // namespace mortise::effects
