#pragma once
// Joints between stiff bodies as what drives, limits and reports see of them: where they are, and the coordinate that they leave free. A joint is
// held by its tie (model/ties.h); this is its name and its frame.
#include <string>
#include <vector>

#include "base/error.h"
#include "model/coordinate.h"
#include "model/ties.h"

namespace mortise::model {

class Model;

enum class JointType { fixed, spherical, revolute, prismatic };

// The coordinate of a revolute joint is the angle of `body` against `to`, right-handed about `axis` [rad]; that of a prismatic one the way of `body`
// along it [m].
struct Joint {
  std::string name;  // as its tie is called
  SourceLoc where;
  JointType type = JointType::fixed;
  Index env = 0, body = 0, to = 0;  // to: Tie::kWorld
  Vec3 place, axis;                 // world coordinates at rest; the axis is of unit length
  Index tie = 0;                    // in Ties::list()
  Index follower = 0;               // which of the two bodies the tie lets follow the other
  bool mimics = false;              // another joint: the tie leaves nothing free
  Index leader = -1;                // a joint that it follows, `ratio` times as far from where both stand at rest; -1: none
  double ratio = 1;
  double at_rest = 0;  // the coordinate as the bodies stand at rest,
  double low, high;    // and what it may be
  // Of the accepted state:
  double value = 0, before = 0;      // turns are counted; a step earlier
  double rate = 0, rate_before = 0;  // as the integrator has it [1/s]; likewise
  // Where what steps leave out is mended (effects/integrator.h): what rate and acceleration of the step under way are more.
  double ahead = 0, behind = 0;
  bool has_coordinate() const { return type == JointType::revolute || type == JointType::prismatic; }
  const char* unit() const { return type == JointType::prismatic ? "m" : "rad"; }
  const char* effort_unit() const { return type == JointType::prismatic ? "N" : "N m"; }
};

// The joints of that name, one of every environment that has it; where there is none Error(Exit::scene) at `cited`, with the names that there are.
std::vector<Index> joints_named(const Model& model, const std::string& name, const SourceLoc& cited);

// As kernels see it, with its coordinate at the accepted state.
Coordinate coordinate_of(const Model& model, const Joint& joint);

// How the body that follows does so where the coordinate is given: turned by that angle from rest, or moved by that way,
//     A_c = A_t R,  p_c = p_t + A_t (X - R Y)      R: about the axis; X, Y: the joint's place in the two bodies from their centres
//     A_c = A_t,    p_c = p_t + A_t (X + s u)      X: the centre of c in t
// linear in the blocks of t like a fixed joint.
std::vector<Follow> placed_at(const Model& model, const Joint& joint, double value);
// The axis as the body `to` has it.
Follow axis_of(const Model& model, const Joint& joint);

// Prismatic joints of which no coordinate is given guide the centre of the body that follows along the axis of the other. Where that is prescribed at
// all times it is a support across the axis (Model::projector), where it will be at the end of the step, once targets and driven ties say so; on one
// that moves freely, and where other joints of a loop have the slide itself follow, it is the effect's matter (effects/joint/equations.h).
void guide(Model& model);
bool guided_by_support(const Model& model, const Joint& prismatic);

// Those that are.
struct Guided {
  Index joint;            // of Model::joints
  Index slider, carrier;  // bodies; Tie::kWorld is none
};
std::vector<Guided> guided(const Model& model);

}  // namespace mortise::model
