#pragma once
#include "importers/urdf/machine.h"
#include "importers/urdf/meshes.h"

namespace mortise::importers::urdf {

struct Request {
  std::string robot;  // the file
  MeshOptions meshes;
  MachineOptions machine;
  std::string target;   // where the scene will lie: paths of meshes are relative to its folder
  std::string command;  // that asked for it
};

// The robot as the text of a scene. Throws Error(Exit::scene, Exit::file, Exit::usage).
std::string import_scene(const Request& request, Notes& notes);

}  // namespace mortise::importers::urdf
