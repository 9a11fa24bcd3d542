#pragma once
// The part of a master triangle that faces a slave triangle: the master triangle is projected along the slave normal n onto the
// slave plane and clipped there by the slave's three sides (Sutherland, Hodgman 1974), in barycentric coordinates N of the slave.
// A corner carries its master barycentrics M along, so that the projection never has to be inverted: slivers and faces nearly
// perpendicular to the slave lose no accuracy, and no length enters that would have to be compared with a tolerance.
//
// Master triangles with a common edge project its end points to the same numbers, and every intersection is computed from the
// inner to the outer end point, so both get the same corners bit by bit. Their clipped areas therefore add up to the clipped area
// of their union to rounding: over a covered slave triangle to its own area, whatever the meshes (none is too small to count).
#include <cmath>

#include "base/jet.h"
#include "base/types.h"

namespace mortise::effects::mortar {

// Corners of a triangle cut by five lines (the slave's sides, two levels of the gap): 8, and a few more where rounding makes a sliver
// not quite convex.
inline constexpr int kCorners = 10;

template <class T>
struct CornerOf {
  T N[3];  // barycentrics on the slave
  T M[3];  // on the master
};
using Corner = CornerOf<double>;

template <class T>
struct PolygonOf {
  int n = 0;
  CornerOf<T> v[kCorners];
  MORTISE_HD void push(const CornerOf<T>& c) {
    if (n < kCorners) v[n++] = c;
  }
};
using Polygon = PolygonOf<double>;

// A slave triangle: corner a0, edges e1, e2, unit normal n, area [m^2].
struct SlavePlane {
  Vec3 a0, e1, e2, n;
  double area;
};

MORTISE_HD inline SlavePlane slave_plane(const Vec3& a0, const Vec3& a1, const Vec3& a2) {
  SlavePlane p{a0, a1 - a0, a2 - a0, Vec3::Zero(), 0};
  p.n = p.e1.cross(p.e2);
  const double twice = p.n.norm();
  p.area = twice / 2;
  p.n /= twice;
  return p;
}

// Barycentrics N of the projection of x; returns its height over the plane [m].
MORTISE_HD inline double project(const SlavePlane& p, const Vec3& x, double N[3]) {
  const Vec3 r = x - p.a0;
  const double twice = 2 * p.area;
  N[1] = r.cross(p.e2).dot(p.n) / twice;
  N[2] = p.e1.cross(r).dot(p.n) / twice;
  N[0] = 1 - N[1] - N[2];
  return r.dot(p.n);
}

// The corner between one inside and one outside, at the share t of the way.
template <class T>
MORTISE_HD inline CornerOf<T> cut(const CornerOf<T>& in, const CornerOf<T>& out, const T& t) {
  CornerOf<T> c;
  for (int k = 0; k < 3; ++k) {
    c.N[k] = in.N[k] + t * (out.N[k] - in.N[k]);
    c.M[k] = in.M[k] + t * (out.M[k] - in.M[k]);
  }
  return c;
}

// q: what of a polygon lies where the linear function inside(corner) >= 0; finish(c) is called for every new corner. Polygons are never copied: a
// kernel would hold a whole one in registers on the way.
template <class T, class Inside, class Finish>
MORTISE_HD inline void keep(const PolygonOf<T>& p, const Inside& inside, const Finish& finish, PolygonOf<T>& q) {
  q.n = 0;
  for (int i = 0; i < p.n; ++i) {
    const CornerOf<T>&a = p.v[i], &b = p.v[i + 1 < p.n ? i + 1 : 0];
    const T at_a = inside(a), at_b = inside(b);
    if (at_a >= 0) q.push(a);
    if ((at_a >= 0) == (at_b >= 0)) continue;
    CornerOf<T> c = at_a >= 0 ? cut<T>(a, b, at_a / (at_a - at_b)) : cut<T>(b, a, at_b / (at_b - at_a));
    finish(c);
    q.push(c);
  }
}

// L[k]: slave barycentrics of projected master corner k. Empty where nothing overlaps. room: for what lies between.
template <class T>
MORTISE_HD inline void clip(const T L[3][3], PolygonOf<T>& out, PolygonOf<T>& room) {
  room.n = 0;
  for (int k = 0; k < 3; ++k) room.push({{L[k][0], L[k][1], L[k][2]}, {k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0}});
  MORTISE_ROLLED for (int side = 0; side < 3; ++side) {
    const auto inside = [side](const CornerOf<T>& c) { return c.N[side]; };
    const auto finish = [side](CornerOf<T>& c) { c.N[side] = 0; };
    keep(side == 1 ? out : room, inside, finish, side == 1 ? room : out);
  }
}
MORTISE_HD inline Polygon clip(const double L[3][3]) {
  Polygon out, room;
  clip(L, out, room);
  return out;
}

// Area of fan triangle (0, i, i+1) as a share of the slave's, positive where the master's projection turns against the slave
// (the faces look at each other).
template <class T>
MORTISE_HD inline T fan_area(const PolygonOf<T>& p, int i) {
  const CornerOf<T>&o = p.v[0], &a = p.v[i], &b = p.v[i + 1];
  return (b.N[1] - o.N[1]) * (a.N[2] - o.N[2]) - (a.N[1] - o.N[1]) * (b.N[2] - o.N[2]);
}
MORTISE_HD inline double polygon_area(const Polygon& p) {
  double sum = 0;
  for (int i = 1; i + 1 < p.n; ++i) sum += fan_area(p, i);
  return sum;
}

// The part [t0, t1] of the segment from P to Q (slave barycentrics) within the slave triangle whose side k is moved outwards by
// tolerance[k]; t0 > t1 if none.
template <class T>
MORTISE_HD inline void clip_segment(const T P[3], const T Q[3], const T tolerance[3], T& t0, T& t1) {
  t0 = 0, t1 = 1;
  for (int side = 0; side < 3; ++side) {
    const T p = P[side] + tolerance[side], q = Q[side] + tolerance[side];
    if (p < 0 && q < 0)
      t1 = -1;
    else if (p < 0)
      t0 = larger(t0, p / (p - q));
    else if (q < 0)
      t1 = smaller(t1, p / (p - q));
  }
}

}  // namespace mortise::effects::mortar
