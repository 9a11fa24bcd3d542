#pragma once
#include <string>
#include <vector>

#include "base/params.h"
#include "engine/engine.h"
#include "model/input.h"

namespace mortise::run {

// Everything that a run of the scene does before it solves its first step: reads the meshes, makes the engine, looks for bodies that touch
// and at what cameras, sensors and `resets` (conditions of environments.reset) see. Throws the Error that the run would end with. Returns the engine,
// which has not stepped.
std::unique_ptr<engine::Engine> check_start(const Params& scene, const model::ModelInput& input, const std::vector<Params>& resets = {});

// Scalars that are asked for (`what`) beside the scene. Throws Error(Exit::scene) at `where` if its start tells that nothing will report one;
// what keeps it from starting at all its run will tell.
void check_reported(const Params& scene, const std::vector<std::string>& scalars, const std::string& what, const SourceLoc& where);

}  // namespace mortise::run
