#pragma once
// The box around points, on the host.
#include <cmath>
#include <span>

#include "base/types.h"

namespace mortise::geometry {

// Empty until it includes a point.
struct Bounds {
  Vec3 lo = Vec3::Constant(INFINITY), hi = Vec3::Constant(-INFINITY);
  void include(const Vec3& x) { lo = lo.cwiseMin(x), hi = hi.cwiseMax(x); }
  Vec3 size() const { return hi - lo; }
  Bounds grown(double by) const { return {lo - Vec3::Constant(by), hi + Vec3::Constant(by)}; }
  bool holds(const Vec3& x) const { return (x.array() >= lo.array()).all() && (x.array() <= hi.array()).all(); }
  bool meets(const Bounds& o) const { return (lo.array() <= o.hi.array()).all() && (o.lo.array() <= hi.array()).all(); }
};

inline Bounds bounds_of(std::span<const Vec3> points) {
  Bounds out;
  for (const Vec3& x : points) out.include(x);
  return out;
}

}  // namespace mortise::geometry
