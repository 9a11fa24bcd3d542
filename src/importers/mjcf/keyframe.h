#pragma once
#include "importers/element.h"
#include "importers/robot/robot.h"

namespace mortise::importers::mjcf {

// Where the joints stand in the key that is called home, or else the first.
void read_keyframe(const Element& root, Robot& robot, Notes& notes);

}  // namespace mortise::importers::mjcf
