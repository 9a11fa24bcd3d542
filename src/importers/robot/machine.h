#pragma once
// A robot as a scene has it: what moves as one is one body, placed in the world with its joints where they are to stand.
#include "importers/notes.h"
#include "importers/robot/robot.h"
#include "importers/robot/tuning.h"

namespace mortise::importers {

// Links that become soft pads, by pattern with * and ?.
struct SoftLink {
  std::string link;
  double youngs_modulus = kRubber, poisson_ratio = kRubberPoisson;  // [Pa]
  double edge_length = 0;                                           // [m]; 0: what suits the pad's size
  SoftLink(std::string name) : link(std::move(name)) {}
  SoftLink(const char* name) : link(name) {}
};

// How legs step; what is absent is chosen by their length.
struct GaitOptions {
  std::string type;                                       // of gait.h; "": they stand
  std::optional<double> period, stride, clearance, duty;  // [s], [m], [m], share of a cycle
  std::string asked = "--gait ";                          // how messages call what asked for it
};

// Where joints stand [rad, m], by pattern with * and ?.
struct Stand {
  enum class As { any, angle, length };  // what it was given as
  std::string joint;
  double value = 0;
  As as = As::any;
};

struct MachineOptions {
  std::vector<Stand> stands;                                     // of those that fit a joint the right-most holds
  std::vector<SoftLink> soft;                                    // of those that fit a link the right-most holds
  bool held = false;                                             // no robot's base moves
  double clearance = 2e-3;                                       // of the lowest point above the floor z = 0 [m]
  double sway = 0;                                               // motors swing their hinges by this about where they stand [rad]
  int apart = 2;                                                 // bodies that no more joints than these lie between pass through each other
  std::vector<std::pair<std::string, Vec3>> colours;             // links, by pattern: sRGB of the body that has them
  std::string asked_soft = "--soft ", asked_joint = "--joint ";  // how messages call what asked for a soft link, for a joint's place
  GaitOptions gait{};
};

struct Body {
  std::string name;
  std::vector<std::string> links;  // the first gives the body's frame
  std::vector<Shape> shapes;       // in it
  std::vector<Shape> visuals;      // in it
  std::vector<Shape> unseen;       // of links without visuals: drawn where a mesh of the body is missing
  bool undrawn = false;            // and so it is
  std::optional<Shape> drawn;      // a mesh; see draw.h
  std::optional<Vec3> colour;
  bool one_colour = false;  // whatever its visuals have
  Inertial inertial;        // in its frame
  bool even = false;        // the mass fills the shapes evenly: no tensor is known
  bool held = false;
  bool bearing = false;  // between two joints of one body of the file
  Pose at;               // in the world
  SourceLoc where;
};

struct Axis {  // a joint that moves: a hinge, a slide, a ball joint
  std::string name;
  Joint::Type type = Joint::Type::revolute;
  std::size_t body = 0;
  std::ptrdiff_t to = -1;  // -1: the world
  Vec3 place, direction;   // in the world
  double stands = 0;
  std::optional<std::pair<double, double>> limits;
  double kp = 0, kd = 0, effort = 0, velocity = 0, damping = 0, friction = 0;
  double stiffness = 0, rest = 0, armature = 0;
  std::ptrdiff_t mimics = -1;  // the axis that it follows exactly, `ratio` times as far
  double ratio = 1;
  double swing = 0;      // amplitude of its motor's target [rad, m]
  bool passive = false;  // without a motor
  struct Step {
    std::size_t upper, lower;  // hinges of its leg
    Vec3 foot;                 // in the world
    double phase;
  };
  std::optional<Step> step;
  SourceLoc where;
};

struct ClosingJoint {  // of a loop: a ball joint, or a fixed one
  std::string name;
  bool fixed = false;
  std::size_t body = 0;
  std::ptrdiff_t to = -1;  // -1: the world
  Vec3 place;              // in the world
};

// A link that becomes a soft body, bonded to the body that it was fixed to.
struct Pad {
  std::string name;
  std::size_t body = 0;
  Shape shape;  // in the world
  std::optional<Vec3> colour;
  double density = 0;                                               // [kg/m^3]
  double youngs_modulus = kRubber, poisson_ratio = kRubberPoisson;  // [Pa]
  double edge_length = 0;                                           // [m]; 0: what suits its size
  SourceLoc where;
};

struct Machine {
  std::string name;
  std::vector<Body> bodies;
  std::vector<Axis> axes;
  std::vector<ClosingJoint> loops;
  std::vector<Pad> pads;
  struct Gait {
    double period, stride, clearance, duty;
  };
  std::optional<Gait> gait;
  double floor = 0;                                        // where it lies [m]
  std::vector<std::pair<std::size_t, std::size_t>> apart;  // bodies and pads (numbered after the bodies) that the file says shall not touch
  double mass() const;
};

// Links that fixed joints tie are one body, whose mass, centre and tensor are those of all. What has no mass, or moments of inertia that no body
// has, gets some (the README says which), with a note. Throws Error(Exit::scene), Error(Exit::usage) for options that name nothing.
Machine assemble(const Robot& robot, const MachineOptions& options, Notes& notes);

}  // namespace mortise::importers
