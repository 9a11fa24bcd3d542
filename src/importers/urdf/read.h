#pragma once
#include "importers/notes.h"
#include "importers/urdf/robot.h"

namespace mortise::importers::urdf {

// Throws Error(Exit::file) where the file cannot be read, Error(Exit::scene) with file, line and column where it is no robot. What is left out, and
// attributes and elements that no URDF has, are noted.
Robot read(const std::string& path, Notes& notes);
Robot read_text(const std::string& text, const std::string& path, Notes& notes);

}  // namespace mortise::importers::urdf
