#pragma once
#include "importers/element.h"
#include "importers/robot/robot.h"

namespace mortise::importers::mjcf {

// The part of MJCF that is about bodies: trees of bodies with geoms, joints and inertials, classes of defaults, meshes, frames, includes, excludes,
// what motors can do, joints that follow others. What is left out is noted. Throws Error(Exit::scene) with file, line and column, Error(Exit::file)
// where an included file is not there.
Robot read(Document& document, Notes& notes);

}  // namespace mortise::importers::mjcf
