#pragma once
#include <functional>
#include <map>

#include "importers/notes.h"
#include "importers/robot/robot.h"

namespace mortise::importers {

struct MeshOptions {
  std::map<std::string, std::string> packages;  // folder of package://NAME
  bool skip_missing = false;
  // What messages advise where a package is not found, and a mesh is missing.
  std::function<std::string(const std::string& package)> where = [](const std::string& p) {
    return "\n  --package " + p + "=FOLDER says where the package is";
  };
  std::string skip_hint = "\n  --missing-meshes skip goes on without them";
  std::string folder;  // for meshes that have to be written anew; made when the first one is
};

// Finds the files of all meshes; shapes whose file is missing are an error that names them all, or left out with a note. package://NAME/... is sought
// in `packages`, in folders called NAME above the robot's file or beside one of these, and in those that ROS_PACKAGE_PATH lists.
void find_meshes(Robot& robot, const MeshOptions& options, Notes& notes);

// Makes the meshes of collisions surfaces that a stiff body can have: one that is closed, of one scale and sound stays as it is; of any other the
// convex hull is written into `options.folder`, with a note.
void mend_collision_meshes(Robot& robot, const MeshOptions& options, Notes& notes);

}  // namespace mortise::importers
