#pragma once
// A slave triangle with the master triangles near it.
#include <cmath>

#include "effects/mortar_contact/clip.h"
#include "effects/mortar_contact/view.h"

namespace mortise::effects::mortar {

// A master triangle over a slave triangle.
template <class T>
struct FacingOf {
  T L[3][3], height[3];  // slave barycentrics and heights of its corners
  T cosine = 0;          // -n . n_master: 1 where they look at each other
};
using Facing = FacingOf<double>;

template <class T>
using Vec3Of = Eigen::Matrix<T, 3, 1>;
// Eigen's own does not take jets.
template <class T>
MORTISE_HD inline Vec3Of<T> cross(const Vec3Of<T>& a, const Vec3Of<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// A slave triangle. With jets lengths and places are what counts: axes may be its own (moving.cpp).
template <class T>
struct SlaveOf {
  Index slave;     // triangle
  Vec3Of<T> y[3];  // its corners
  T area;
  T bend[3];              // against the neighbours over its sides (consistent.h)
  double support, reach;  // samples with a gap below `reach` are wanted
  // Distance of corner k from the opposite side [m].
  MORTISE_HD T altitude(int k) const {
    const Vec3Of<T> e1 = y[1] - y[0], e2 = y[2] - y[0];
    return 2 * area / root(k == 0 ? Vec3Of<T>(e2 - e1).squaredNorm() : k == 1 ? e2.squaredNorm() : e1.squaredNorm());
  }
};

// With the master triangles near it.
struct Patch : SlaveOf<double> {
  SlavePlane plane;
  Index masters;         // so many of them:
  const Index* master;   // triangles,
  const Facing* facing;  // and what they look like from here
};

// Distance [m] of the point with barycentrics w in a triangle's plane from its rim: positive inside.
template <class T>
MORTISE_HD inline T rim_distance(const Vec3Of<T> y[3], const T w[3]) {
  Vec3Of<T> x = Vec3Of<T>::Zero();
  for (int k = 0; k < 3; ++k) x += w[k] * y[k];
  T least = INFINITY;
  MORTISE_ROLLED for (int k = 0; k < 3; ++k) {
    const Vec3Of<T>&a = y[k], e = y[(k + 1) % 3] - a;
    const T t = smaller(larger((x - a).dot(e) / e.squaredNorm(), T(0.0)), T(1.0));
    least = smaller(least, (x - a - t * e).squaredNorm());
  }
  const T distance = root(least);
  return w[0] >= 0 && w[1] >= 0 && w[2] >= 0 ? distance : -distance;
}

// A segment over a slave triangle, in up to three parts: t[0]..t[1]..t[2]..t[3].
template <class T>
struct Stretches {
  T t[4];
};

}  // namespace mortise::effects::mortar
