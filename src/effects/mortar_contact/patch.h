#pragma once
// A slave triangle with the master triangles near it.
#include <cmath>

#include "effects/mortar_contact/clip.h"
#include "effects/mortar_contact/view.h"

namespace mortise::effects::mortar {

// A master triangle over a slave triangle.
struct Facing {
  double L[3][3], height[3];  // slave barycentrics and heights of its corners
};

// A slave triangle with the master triangles near it.
struct Patch {
  Index slave;  // triangle
  Vec3 y[3];    // its corners
  SlavePlane plane;
  double bend[3];         // against the neighbours over its sides (consistent.h)
  double support, reach;  // samples with a gap below `reach` are wanted
  Index masters;          // so many of them:
  const Index* master;    // triangles,
  const Facing* facing;   // and what they look like from here
};

// Distance [m] of the point with barycentrics w in a triangle's plane from its rim: positive inside.
MORTISE_HD inline double rim_distance(const Vec3 y[3], const double w[3]) {
  Vec3 x = Vec3::Zero();
  for (int k = 0; k < 3; ++k) x += w[k] * y[k];
  double least = INFINITY;
  MORTISE_ROLLED for (int k = 0; k < 3; ++k) {
    const Vec3 &a = y[k], e = y[(k + 1) % 3] - a;
    const double t = std::fmin(std::fmax((x - a).dot(e) / e.squaredNorm(), 0.0), 1.0);
    least = std::fmin(least, (x - a - t * e).squaredNorm());
  }
  const double distance = std::sqrt(least);
  return w[0] >= 0 && w[1] >= 0 && w[2] >= 0 ? distance : -distance;
}

// A segment over a slave triangle, in up to three parts: t[0]..t[1]..t[2]..t[3].
struct Stretches {
  double t[4];
};

}  // namespace mortise::effects::mortar
