#pragma once
#include "model/input.h"
#include "output/mesh.h"

namespace mortise::run {

// The mesh of the output files: all points of all bodies, body after body (the engine's point order); soft bodies as
// tetrahedra, stiff bodies as triangles.
output::OutputMesh output_mesh(const model::ModelInput& input);

}  // namespace mortise::run
