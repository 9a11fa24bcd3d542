#pragma once
#include "importers/element.h"
#include "importers/robot/robot.h"

namespace mortise::importers::urdf {

// Throws Error(Exit::scene) with file, line and column where the file is no robot. What is left out, and attributes and elements that no URDF has,
// are noted.
Robot read(const Document& document, Notes& notes);

}  // namespace mortise::importers::urdf
