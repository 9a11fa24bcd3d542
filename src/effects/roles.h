#pragma once
// Who asks for the roles of a scene's effects, by the names that the scene gives them.
#include <string>
#include <string_view>
#include <vector>

#include "base/params.h"
#include "effects/kind.h"

namespace mortise::effects {

bool has_role(std::string_view name, Role role);
// Those of the scene's block `effects` that have the role.
std::vector<std::string> of_role(const Params& effects, Role role);
// Entries of their lists that name this `body`.
std::vector<const Params*> of_body(const Params& effects, Role role, std::string_view body);

}  // namespace mortise::effects
