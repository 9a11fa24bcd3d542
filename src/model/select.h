#pragma once
#include <span>
#include <string>
#include <vector>

#include "base/params.h"
#include "base/types.h"

namespace mortise::model {

// Places in `rest` (positions of one body at rest) that satisfy a `where` block of the scene: {side: ...}, {box: ...} or {sphere:
// ...}. A side is met within 1e-6 of the size of the body.
std::vector<Index> select(std::span<const Vec3> rest, const Params& where);
std::vector<Index> select(std::span<const Vec3> rest, const Params* where);  // all of them without a block

// Throws: `where` holds no `what` ("node") of a body that is there at rest; with the reason that can be seen.
[[noreturn]] void selects_nothing(const Params& where, const std::string& what, const std::string& body, std::span<const Vec3> rest);

}  // namespace mortise::model
