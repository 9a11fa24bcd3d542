#pragma once
#include <string>

#include "geometry/mesh.h"

namespace mortise::geometry {

// A mesh as bytes, for another process on this machine.
std::string to_bytes(const VisualMesh& mesh);

// Its inverse. The bytes are not believed: whatever they are, a mesh with indices within its arrays is returned or Exit::scene thrown; `path` is for
// the message.
VisualMesh visual_from_bytes(const std::string& path, const std::string& bytes);

}  // namespace mortise::geometry
