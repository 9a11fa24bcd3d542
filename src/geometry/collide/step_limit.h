#pragma once
#include <vector>

#include "geometry/collide/broadphase.h"

namespace mortise::geometry {

// Lowers alpha of the environments (values <= 1) so that on the way from y to y + alpha dy every pair of environment e in the broad phase
// keeps more than the share `keep` of its present distance, bounds on rounding included. The pairs must come from an update with
// the same y and dy. A value becomes 0 only where primitives touch already.
void limit_step(const ChosenPairs& pairs, device::View<const Vec3> y, device::View<const Vec3> dy, double keep, device::EnvValues alpha);
void limit_step(const Broadphase& pairs, device::View<const Vec3> y, device::View<const Vec3> dy, double keep, device::EnvValues alpha);

}  // namespace mortise::geometry
