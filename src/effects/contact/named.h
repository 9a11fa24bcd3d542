#pragma once
// Whom blocks of pairs in a scene name.
#include <set>
#include <string>

#include "base/params.h"

namespace mortise::effects::contact {

// All names in a block of pairs, or in one of them: {slave, master}, [a, b] or {bodies: [...]}.
std::set<std::string> named(const Params& pairs);
// Do the two bodies pass through each other because the scene says so (`pairs` with `collide: false`)?
bool pass(const Params& scene, const std::string& a, const std::string& b);

}  // namespace mortise::effects::contact
