#pragma once
#include "base/params.h"
#include "engine/engine.h"
#include "model/input.h"

namespace mortise::run {

// Everything that a run of the scene does before it solves its first step: reads the meshes, makes the engine, looks for bodies that touch
// and at what cameras, sensors and `resets` (conditions of environments.reset) see. Throws the Error that the run would end with. Returns the engine,
// which has not stepped.
std::unique_ptr<engine::Engine> check_start(const Params& scene, const model::ModelInput& input, const std::vector<Params>& resets = {});

}  // namespace mortise::run
