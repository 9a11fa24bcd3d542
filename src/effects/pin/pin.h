#pragma once
// A prescribed rigid motion: a point at X at rest is asked to be at
//     x(t) = c + R(t) (X - c) + u(t),     R(t) = rotation by angle(t) about `axis` through `centre` c,
// or several such rotations one after the other, with translation u(t) [m] and angles(t) [rad] between keys linear or smooth in time. A
// direction (column of an affine body) only turns.
#include "base/rotation.h"

namespace mortise::effects::pin {

struct RigidMotion {
  Mat3 R;
  Vec3 shift;  // c + u - R c
};
MORTISE_HD inline Vec3 move_point(const RigidMotion& m, const Vec3& X) { return m.R * X + m.shift; }
MORTISE_HD inline Vec3 move_direction(const RigidMotion& m, const Vec3& d) { return m.R * d; }

// The rotation after `first`.
inline RigidMotion turned(const RigidMotion& first, const Mat3& R, const Vec3& centre) { return {R * first.R, centre + R * (first.shift - centre)}; }
inline RigidMotion turned(const RigidMotion& first, const Vec3& axis, const Vec3& centre, double angle) {
  return turned(first, rotation(axis, angle), centre);
}
inline RigidMotion rigid_motion(const Vec3& axis, const Vec3& centre, double angle, const Vec3& translation) {
  RigidMotion m = turned({Mat3::Identity(), Vec3::Zero()}, axis, centre, angle);
  m.shift += translation;
  return m;
}

}  // namespace mortise::effects::pin
