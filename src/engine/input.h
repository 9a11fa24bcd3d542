#pragma once
// Front end only: the resolved scene and its meshes become the plain input of the engine.
#include "base/params.h"
#include "model/input.h"

namespace mortise::engine {

// Reads or generates every body's mesh and places it. Throws Error(Exit::scene | Exit::file) naming the body.
model::ModelInput make_input(const Params& scene);

}  // namespace mortise::engine
