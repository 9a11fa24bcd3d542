#include "importers/urdf/import.h"

#include "importers/urdf/read.h"
#include "importers/urdf/write.h"

namespace mortise::importers::urdf {

std::string import_scene(const Request& r, Notes& notes) {
  Robot robot = read(r.robot, notes);
  find_meshes(robot, r.meshes, notes);
  mend_collision_meshes(robot, r.meshes, notes);
  const Machine machine = assemble(robot, r.machine, notes);
  return write_scene(machine, passing_pairs(machine, r.machine.apart), r.target, r.command);
}

}  // namespace mortise::importers::urdf
