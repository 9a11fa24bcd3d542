#pragma once
#include "importers/robot/machine.h"
#include "importers/robot/meshes.h"

namespace mortise::importers {

struct Request {
  std::string robot;  // the file
  MeshOptions meshes;
  MachineOptions machine;
  std::string target;   // where the scene will lie: paths of meshes are relative to its folder
  std::string command;  // that asked for it
};

// The robot of a file, URDF or MJCF: what its outermost element says. What is left out, and attributes and elements that the format does not have,
// are noted. Throws Error(Exit::scene) with file, line and column.
Robot read_robot_text(const std::string& text, const std::string& path, Notes& notes);

// The robot as the text of a scene. Throws Error(Exit::scene, Exit::file, Exit::usage).
std::string import_scene(const Request& request, Notes& notes);

}  // namespace mortise::importers
