#pragma once
// A scene with less to do: coarser meshes.
#include <string>

#include "base/params.h"

namespace mortise::cost {

// Does the scene give this body's mesh an edge length?
bool can_be_coarser(const Params& scene, const std::string& body);

// The scene with the edge lengths of soft bodies times `edges`. Stiff bodies keep their shape, which decides what they touch.
Params coarser(const Params& scene, double edges);

}  // namespace mortise::cost
