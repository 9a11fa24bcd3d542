#pragma once
#include <map>

#include "importers/mjcf/compiler.h"
#include "importers/mjcf/defaults.h"

namespace mortise::importers::mjcf {

// What <actuator>, <tendon>, <equality> and <contact> say of joints and bodies that are there. A file with actuators drives only the joints that they
// name; in a file without any all joints have motors.
void read_actuators(const Element& root, const Defaults& defaults, Robot& robot, Notes& notes);
void read_equality(const Element& root, Robot& robot, Notes& notes);
void read_contact(const Element& root, Robot& robot, Notes& notes);

}  // namespace mortise::importers::mjcf
