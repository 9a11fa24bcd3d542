#pragma once
#include <string>
#include <vector>

#include "exporters/frames.h"
#include "render/from_scene.h"

namespace mortise::exporters {

// Animated binary glTF 2.0 of what pictures show: a node per body with its visual mesh, materials, textures and texture coordinates. Stiff bodies are
// moved by their node (translation, rotation); soft ones have a morph target per frame. Half spaces are large squares, pinhole cameras are cameras.
// glTF is y up: a root node turns the scene. `fps` 0: keys at the times of the frames, otherwise one frame after the other at this rate. Throws
// Error(Exit::file).
void write_gltf(const std::string& path, render::SceneView& view, const Frames& frames, const Params& scene, double fps);

}  // namespace mortise::exporters
