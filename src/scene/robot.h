#pragma once
// `robot:` of a scene: a robot's file stands for the bodies, joints, motors and cameras that an import makes of it, and what the scene says itself
// goes over them.
#include <functional>
#include <string>
#include <vector>

#include "base/param_table.h"
#include "base/params.h"
#include "scene/diagnostics.h"
#include "scene/yaml.h"

namespace mortise::scene {

const ParamTable& robot_table();

// Orders in which four legs step: `gait:` of a robot, and `mortise import --gait`.
inline const std::vector<std::string> kGaits{"walk", "trot", "pace", "bound"};

// Makes the text of a scene of a checked `robot` block; the second argument is the path of the scene that it lies in. This folder knows no files of
// robots: the program says once, at its start, who reads them.
using RobotReader = std::function<std::string(const Params& block, const std::string& path)>;
void set_robot_reader(RobotReader reader);

// Takes `robot` out of the tree and puts what it stands for under the rest. Without such a block nothing happens. Errors of the block, and of the
// robot's file, go to `errors`; files that are not there are an Error(Exit::file).
void expand_robot(Node& root, const std::string& path, const std::string& folder, const ParamTable& root_table, Diagnostics& errors);

}  // namespace mortise::scene
