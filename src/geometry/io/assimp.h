#pragma once
#include <string>

#include "geometry/mesh.h"

namespace mortise::geometry {

// STL, PLY, GLB, glTF, DAE. Positions pass through 32-bit floats (assimp's own precision). Render vertices that agree in
// position, normal and texture coordinates are merged, others are not.
VisualMesh read_with_assimp(const std::string& path);

}  // namespace mortise::geometry
