#include "importers/import.h"

#include "base/read_file.h"
#include "importers/mjcf/read.h"
#include "importers/robot/draw.h"
#include "importers/robot/fit.h"
#include "importers/robot/gait.h"
#include "importers/robot/weigh.h"
#include "importers/robot/write.h"
#include "importers/urdf/read.h"

namespace mortise::importers {

Robot read_robot_text(const std::string& text, const std::string& path, Notes& notes) {
  Document document(text, path, text.find("<mujoco") == std::string::npos ? "URDF" : "MJCF");
  const Element root = document.root();
  if (root.name() == "robot") return urdf::read(document, notes);
  if (root.name() == "mujoco") return mjcf::read(document, notes);
  root.fail("the file describes a <" + root.name() + ">, neither a <robot> (URDF) nor a <mujoco> (MJCF)");
}

std::string import_scene(const Request& r, Notes& notes) {
  Robot robot = read_robot_text(read_regular_file(r.robot, max_bytes::scene), r.robot, notes);
  find_meshes(robot, r.meshes, notes);
  fit_primitives(robot);
  weigh(robot);
  mend_collision_meshes(robot, r.meshes, notes);
  Machine machine = assemble(robot, r.machine, notes);
  if (!r.machine.gait.type.empty()) walk(machine, r.machine.gait);
  draw_bodies(machine, r.meshes.folder);
  return write_scene(machine, passing_pairs(machine, r.machine.apart), r.target, r.command);
}

}  // namespace mortise::importers
