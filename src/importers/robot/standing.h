#pragma once
// Where the joints of a robot stand, and with them its links.
#include <vector>

#include "importers/robot/machine.h"

namespace mortise::importers {

struct Standing {
  std::vector<double> at;            // of every joint: its coordinate [rad, m]
  std::vector<std::uint8_t> looped;  // is it part of a loop of joints?
  std::vector<Pose> in_world;        // of every link; the root's frame is the world's
};

// The coordinate of every joint: as asked for, else as near to zero as its limits let it stand. Of a hinge that cannot be straight the parallel one
// before it takes half of the bend back: a leg of two equal links then ends below where it begins. Throws Error(Exit::usage) for options that name
// nothing, or ask for what limits and loops do not let it do.
Standing stand(const Robot& robot, const MachineOptions& options);

// How far motors may swing joints of a kind [rad, m].
double widest_swing(const MachineOptions& options, Joint::Type type);

}  // namespace mortise::importers
