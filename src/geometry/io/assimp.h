#pragma once
#include <string>

#include "geometry/mesh.h"

namespace mortise::geometry {

// GLB, glTF, DAE. Positions pass through 32-bit floats (assimp's own precision). Render vertices that agree in
// position, normal and texture coordinates are merged, others are not. assimp runs in a process of its own, because damaged files crash it.
VisualMesh read_with_assimp(const std::string& path);

}  // namespace mortise::geometry
