#pragma once
// A URDF file as it is written: links, and joints between them. Lengths in m, angles in rad, masses in kg.
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/types.h"

namespace mortise::importers::urdf {

// x -> R x + t: from a frame into the one around it.
struct Pose {
  Mat3 R = Mat3::Identity();
  Vec3 t = Vec3::Zero();
  Vec3 operator()(const Vec3& x) const { return R * x + t; }
  Pose operator*(const Pose& inner) const { return {R * inner.R, R * inner.t + t}; }
};

struct Shape {
  enum class Kind { box, cylinder, sphere, capsule, mesh };  // cylinder and capsule along z, all about their middle
  Kind kind = Kind::box;
  Vec3 size = Vec3::Zero();       // box
  double radius = 0, length = 0;  // of a capsule without its caps
  std::string file;               // mesh: as the URDF names it; once found, its path
  Vec3 scale = Vec3::Ones();      // mesh
  Pose at;                        // in the link
  std::optional<Vec3> colour;     // of visuals
  SourceLoc where;
  bool even() const { return scale[0] > 0 && scale[0] == scale[1] && scale[0] == scale[2]; }  // no axis is scaled or mirrored by itself
};

struct Inertial {
  double mass = 0;
  Vec3 centre = Vec3::Zero();  // of mass, in the link
  Mat3 tensor = Mat3::Zero();  // of inertia about it, in the link's axes [kg m^2]
  SourceLoc where;
};

struct Link {
  std::string name;
  std::optional<Inertial> inertial;
  std::vector<Shape> visuals, collisions;
  SourceLoc where;
};

struct Joint {
  enum class Type { fixed, revolute, prismatic, floating };  // a continuous one is revolute without limits
  std::string name;
  Type type = Type::fixed;
  std::size_t parent = 0, child = 0;  // links
  Pose origin;                        // of the child's frame, and the joint's, in the parent's at zero
  Vec3 axis = Vec3::UnitX();          // in the child's frame
  std::optional<std::pair<double, double>> limits;
  double effort = 0, velocity = 0;  // 0: not given
  double damping = 0, friction = 0;
  struct Mimic {
    std::string joint;
    double multiplier = 1, offset = 0;
    std::size_t leader = 0;  // the joint's number
  };
  std::optional<Mimic> mimic;
  SourceLoc where;
  bool moves() const { return type == Type::revolute || type == Type::prismatic; }
};

struct Robot {
  std::string name, path;
  std::vector<Link> links;
  std::vector<Joint> joints;
  std::size_t root = 0;                  // link without parent
  std::vector<std::size_t> order;        // links, each after its parent
  std::vector<std::ptrdiff_t> joint_of;  // by link: the joint to its parent, -1 for the root
};

}  // namespace mortise::importers::urdf
