#pragma once
// Front end only: the resolved scene and its meshes become the plain input of the engine.
#include "base/params.h"
#include "model/input.h"

namespace mortise::engine {

// Reads or generates every body's mesh and places it. Throws Error(Exit::scene | Exit::file) naming the body.
model::ModelInput make_input(const Params& scene);

// Keeps the meshes of this scene's shapes, before they are placed, for every make_input() of this process and of its children.
void keep_meshes(const Params& scene);

}  // namespace mortise::engine
