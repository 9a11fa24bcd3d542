#pragma once
// Dead load on surface triangles: the force follows neither the motion nor the rotation of the surface. A triangle of rest area
// A [m^2] and outward rest normal n under pressure p [Pa] and traction s [Pa] (force per rest area) carries
//     F = A (s - p n)  [N],  a third of it at each of its vertices.
// With the force f_b [N] on block b the potential is E = -sum_b f_b . (q_b - rest_b), its gradient -f_b; there is no Hessian.
#include "base/types.h"

namespace mortise::effects::pressure_load {

// f_b = p pushed + factor pulled, with `pushed` = -sum w A n / 3 [m^2] and `pulled` = sum w A s / 3 [N].
struct Share {
  Index block, load;
  Vec3 pushed, pulled;
};
struct Strength {
  double pressure;  // [Pa]
  double factor;    // of the traction
};
MORTISE_HD inline Vec3 force(const Share& s, const Strength& now) { return now.pressure * s.pushed + now.factor * s.pulled; }
MORTISE_HD inline double energy(const Vec3& f, const Vec3& q, const Vec3& rest) { return -f.dot(q - rest); }

}  // namespace mortise::effects::pressure_load
