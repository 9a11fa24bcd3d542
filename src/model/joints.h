#pragma once
// Joints between stiff bodies as what drives, limits and reports see of them: where they are, and the coordinate that they leave free. A joint is held
// by its tie (model/ties.h); this is its name and its frame.
#include <string>
#include <vector>

#include "base/error.h"
#include "model/ties.h"

namespace mortise::model {

class Model;

enum class JointType { fixed, spherical, revolute };

// The coordinate of a revolute joint is the angle of `body` against `to`, right-handed about `axis` [rad].
struct Joint {
  std::string name;  // as its tie is called
  SourceLoc where;
  JointType type = JointType::fixed;
  Index env = 0, body = 0, to = 0;  // to: Tie::kWorld
  Vec3 place, axis;                 // world coordinates at rest; the axis is of unit length
  Index tie = 0;                    // in Ties::list()
  double at_rest = 0;               // the coordinate as the bodies stand at rest,
  double low, high;                 // and what it may be
  // Of the accepted state:
  double value = 0;  // turns are counted
  double rate = 0;   // over the last step [1/s]
  bool has_coordinate() const { return type == JointType::revolute; }
};

// The joints of that name, one of every environment that has it; where there is none Error(Exit::scene) at `cited`, with the names that there are.
std::vector<Index> joints_named(const Model& model, const std::string& name, const SourceLoc& cited);

// How the body that follows does so where the coordinate is given: turned by that angle from rest,
//     A_c = A_t R,   p_c = p_t + A_t (X - R Y),        R: about the axis; X, Y: the joint's place in the two bodies from their centres
// c follows t, which may be either of `body` and `to`; linear in the blocks of t like a fixed joint.
std::vector<Follow> placed_at(const Model& model, const Joint& joint, Index child, double value);
// The axis as the body `to` has it.
Follow axis_of(const Model& model, const Joint& joint);

}  // namespace mortise::model
