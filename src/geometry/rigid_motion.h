#pragma once
#include <vector>

#include "base/types.h"

namespace mortise::geometry {

// Where something is and how it stands: origin [m] and the directions x, y, z as columns.
struct Frame {
  Vec3 origin = Vec3::Zero();
  Mat3 axes = Mat3::Identity();
};

// x -> R x + t.
struct Motion {
  Mat3 R = Mat3::Identity();
  Vec3 t = Vec3::Zero();
  Frame moved(const Frame& f) const { return {R * f.origin + t, R * f.axes}; }
};

// Of one point at least.
Vec3 mean(const std::vector<Vec3>& points);

// The rigid motion that takes `from` nearest to `to` (least squares; Kabsch, Acta Cryst. A32, 1976). At least three points that do not
// lie on a line.
Motion nearest_motion(const std::vector<Vec3>& from, const std::vector<Vec3>& to);

// The shortest turn that takes z into the direction of `way`, which is longer than zero.
Mat3 turn_of_z(const Vec3& way);

// Do the points span more than a line?
bool fixes_a_frame(const std::vector<Vec3>& points);

// The same of any points: their mean shift where they span no more than a line.
Motion nearest_motion_of_any(const std::vector<Vec3>& from, const std::vector<Vec3>& to);

// v + w x (x - centre), of points at x [m].
struct RigidVelocity {
  Vec3 centre = Vec3::Zero(), v = Vec3::Zero(), w = Vec3::Zero();  // [m], [m/s], [rad/s]
  Vec3 at(const Vec3& x) const { return v + w.cross(x - centre); }
};
// That nearest to the velocities v of points x (least squares); at rest without any.
RigidVelocity nearest_velocity(const std::vector<Vec3>& x, const std::vector<Vec3>& v);

}  // namespace mortise::geometry
