#pragma once
// A robot as its file says it, whatever the format: links, and joints between them. Lengths in m, angles in rad, masses in kg.
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/types.h"
#include "geometry/mesh.h"
#include "importers/notes.h"

namespace mortise::importers {

// x -> R x + t: from a frame into the one around it.
struct Pose {
  Mat3 R = Mat3::Identity();
  Vec3 t = Vec3::Zero();
  Vec3 operator()(const Vec3& x) const { return R * x + t; }
  Pose operator*(const Pose& inner) const { return {R * inner.R, R * inner.t + t}; }
  Pose inverse() const { return {R.transpose(), -(R.transpose() * t)}; }
};

struct Shape {
  enum class Kind { box, cylinder, sphere, capsule, ellipsoid, mesh };  // cylinder and capsule along z, all about their middle
  Kind kind = Kind::box;
  Vec3 size = Vec3::Zero();                          // box: its sides; ellipsoid: its three diameters
  double radius = 0, length = 0;                     // of a capsule without its caps
  std::string file;                                  // mesh: as the robot's file names it; once found, its path
  std::shared_ptr<const geometry::TriMesh> surface;  // of the mesh, without `scale`; once it was read
  Vec3 scale = Vec3::Ones();                         // mesh
  Pose at;                                           // in the link
  std::optional<Vec3> colour;                        // sRGB
  std::string texture;                               // picture on a mesh that has texture coordinates; "": what its own file says
  std::optional<Kind> fit;                           // a mesh in whose place this primitive stands (fit.h)
  bool fit_box = false;                              // it fits the box around it, not its inertia
  double fit_scale = 1;
  std::optional<double> mass, density;  // [kg, kg/m^3], where shapes weigh what their link does not
  int contype = 1, conaffinity = 1;     // bits: two shapes touch where the one's type meets the other's affinity
  SourceLoc where;
  bool touches(const Shape& o) const { return (contype & o.conaffinity) != 0 || (o.contype & conaffinity) != 0; }
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
  std::optional<Vec3> colour;  // of visuals that are not there
  bool undrawn = false;        // a visual mesh of it is missing
  bool bearing = false;        // without a shape: between two joints of one body
  bool weighed = false;        // its shapes' mass counts, whatever `inertial` is
  SourceLoc where;
};

struct Joint {
  enum class Type { fixed, revolute, prismatic, spherical, floating };  // a continuous one is revolute without limits
  std::string name;
  Type type = Type::fixed;
  std::size_t parent = 0, child = 0;  // links
  Pose origin;                        // of the child's frame, and the joint's, in the parent's at zero
  Vec3 axis = Vec3::UnitX();          // in the child's frame,
  Vec3 at = Vec3::Zero();             // and a point that it goes through
  double zero = 0;                    // coordinate at which the child stands in `origin` [rad, m]
  std::optional<std::pair<double, double>> limits;
  double effort = 0, velocity = 0;  // 0: not given
  double kp = 0, kd = 0;            // gains of its motor; 0: not given
  bool passive = false;             // it has no motor
  double damping = 0, friction = 0;
  double stiffness = 0, rest = 0, armature = 0;  // of a spring, at ease at `rest`; of a rotor
  std::optional<double> stand;                   // where the file says that it stands, if not at zero
  struct Mimic {
    std::string joint;
    double multiplier = 1, offset = 0;
    std::size_t leader = 0;  // the joint's number
  };
  std::optional<Mimic> mimic;
  SourceLoc where;
  bool moves() const { return type == Type::revolute || type == Type::prismatic; }  // by one coordinate
  Pose motion(double coordinate) const;                                             // of the child in `origin`
  void fix_where_it_cannot_move(Notes& notes);                                      // because its limits leave no way
};

// A joint that closes a loop, or holds a free body: `b` is where it stands.
struct Loop {
  std::string name;
  bool fixed = false;        // else a ball joint
  std::size_t a = 0, b = 0;  // links
  Vec3 at = Vec3::Zero();    // in a
  SourceLoc where;
};

struct Robot {
  std::string name, path;
  std::vector<Link> links;
  std::vector<Joint> joints;
  std::vector<Loop> loops;
  std::vector<std::pair<std::size_t, std::size_t>> apart;  // links that pass through each other, as the file says
  std::vector<std::string> freed;                          // joints of the file that a floating one stands for
  std::size_t root = 0;                                    // link without parent
  std::vector<std::size_t> order;                          // links, each after its parent
  std::vector<std::ptrdiff_t> joint_of;                    // by link: the joint to its parent, -1 for the root

  // Finds root, order and joint_of, and whom joints mimic. Every link hangs on one other, all on one root: throws Error(Exit::scene) otherwise.
  void make_tree();

  // The surface of a mesh that was found. Each file is read once. Throws Error with the shape's place.
  void read_surface(Shape& shape);

 private:
  std::map<std::string, std::shared_ptr<const geometry::TriMesh>> surfaces_;  // by path
};

}  // namespace mortise::importers
