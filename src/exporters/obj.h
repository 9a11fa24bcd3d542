#pragma once
#include <string>

#include "exporters/frames.h"
#include "render/from_scene.h"

namespace mortise::exporters {

// The files of such a sequence: STEM_0042.obj of every frame, STEM.mtl for all of them, STEM_texture_0.png and so on.
std::string obj_of_frame(const std::string& stem, long frame);

// One OBJ file per frame with every body (`o NAME`) where it is then, with normals and texture coordinates; materials and textures beside them.
// Metres, the axes of the scene. Half spaces are left out. Throws Error(Exit::file).
void write_objs(const std::string& stem, render::SceneView& view, const Frames& frames);

}  // namespace mortise::exporters
