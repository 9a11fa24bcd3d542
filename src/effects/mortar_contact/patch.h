#pragma once
// A slave triangle with the master triangles near it, and which slave triangles a master's edge or tip belongs to.
#include <cmath>

#include "effects/mortar_contact/sheet.h"

namespace mortise::effects::mortar {

// A slave triangle with the master triangles near it.
struct Patch {
  Index slave;  // triangle
  Vec3 y[3];    // its corners
  SlavePlane plane;
  double bend[3];         // below
  Sheet face;             // where the scene has quadratic faces
  double support, reach;  // samples with a gap below `reach` are wanted
  const Index* master;    // triangles
  Index masters;
};

// ---- where samples of edges and points belong, tapered: to the triangle below, or to all that have it on their rim ----

// Does slave triangle t go on in the direction of n (rather than round a rim)?
MORTISE_HD inline bool goes_on(const Scene& s, const Vec3& n, Index t) { return n.dot(s.normal[t]) > 0.5; }

// One over the number of slave triangles that find what lies on side k of `slave`.
MORTISE_HD inline double side_multiplicity(const Scene& s, Index slave, const Vec3& n, int k) {
  const Index edge = s.topology.triangle_edge[3 * slave + (k + 1) % 3];
  Index count = 0;
  for (Index j = s.topology.edge_offset[edge]; j < s.topology.edge_offset[edge + 1]; ++j)
    if (goes_on(s, n, s.topology.edge_triangle[j])) ++count;
  return count > 1 ? 1.0 / count : 1;
}

// The same for a master vertex above N.
MORTISE_HD inline double multiplicity(const Scene& s, Index slave, const Vec3& n, const double N[3]) {
  int on = 0, side = 0, corner = 0;
  for (int k = 0; k < 3; ++k) {
    if (N[k] <= kOnSide)
      ++on, side = k;
    else
      corner = k;
  }
  if (on == 0) return 1;
  if (on == 1) return side_multiplicity(s, slave, n, side);
  const Index v = s.surface.triangles[slave].v[corner];
  Index count = 0;
  for (Index j = s.topology.point_offset[v]; j < s.topology.point_offset[v + 1]; ++j)
    if (goes_on(s, n, s.topology.point_triangle[j])) ++count;
  return count > 1 ? 1.0 / count : 1;
}

// ---- the same, consistent: to all triangles nearby, so that forces are continuous ----

// Distance [m] of the point with barycentrics w in a triangle's plane from its rim: positive inside.
MORTISE_HD inline double rim_distance(const Vec3 y[3], const double w[3]) {
  Vec3 x = Vec3::Zero();
  for (int k = 0; k < 3; ++k) x += w[k] * y[k];
  double least = INFINITY;
  for (int k = 0; k < 3; ++k) {
    const Vec3 &a = y[k], e = y[(k + 1) % 3] - a;
    const double t = std::fmin(std::fmax((x - a).dot(e) / e.squaredNorm(), 0.0), 1.0);
    least = std::fmin(least, (x - a - t * e).squaredNorm());
  }
  const double distance = std::sqrt(least);
  return w[0] >= 0 && w[1] >= 0 && w[2] >= 0 ? distance : -distance;
}

// How far slave triangle t is bent against its neighbour over side k: 0 where they lie in one plane, 1 from 1 degree on.
MORTISE_HD inline double bend(const Scene& s, Index t, int k, const Vec3& n) {
  constexpr double kBent = 1.523048436087608e-4;  // 1 - cos 1 deg
  const Index edge = s.topology.triangle_edge[3 * t + (k + 1) % 3];
  double most = 0;
  for (Index j = s.topology.edge_offset[edge]; j < s.topology.edge_offset[edge + 1]; ++j)
    most = std::fmax(most, 1 - n.dot(s.normal[s.topology.edge_triangle[j]]));
  return hermite(most / kBent);
}

// Half the width [m] of the strip along side k in which triangle and neighbour share what lies at a gap above.
MORTISE_HD inline double strip(const Patch& p, int k, double gap) {
  constexpr double kLeast = 1e-10;  // of the altitude: what lies this near to a side lies on it
  return std::fmax(p.bend[k] * gap, kLeast * p.plane.altitude(k));
}
// How much a point above w belongs to the triangle: 1 inside, 0 outside, and in between in the strips along its sides. Where the slave is
// bent they are as wide as the gap, so that the force on an edge or a tip that slides from one triangle to the next turns with it
// rather than jumping from one normal to the other. Over a common side the shares of both triangles add up to 1. The last factor
// ends what the product of strips goes beyond a sharp corner.
MORTISE_HD inline double belongs(const Patch& p, const double w[3], double gap) {
  if (!(gap > 0)) return 0;
  double share = 1;
  for (int k = 0; k < 3; ++k) share *= hermite(0.5 + w[k] * p.plane.altitude(k) / (2 * strip(p, k, gap)));
  return share > 0 ? share * hermite(2 + 2 * rim_distance(p.y, w) / gap) : 0;
}

// A segment over a slave triangle and its outer strips, cut where it enters and leaves what is within all inner ones.
struct Stretches {
  double t[4];
};
MORTISE_HD inline bool stretches(const Patch& p, const double P[3], const double Q[3], double gap, Stretches& out) {
  double grow[3], shrink[3];
  for (int k = 0; k < 3; ++k) grow[k] = strip(p, k, gap) / p.plane.altitude(k), shrink[k] = -grow[k];
  double in, back;
  clip_segment(P, Q, grow, out.t[0], out.t[3]);
  if (!(out.t[0] < out.t[3])) return false;
  clip_segment(P, Q, shrink, in, back);
  if (in > back) in = back = 0.5 * (in + std::fmax(back, 0.0));  // nothing is inside: one cut, where the inside would appear
  out.t[1] = std::fmin(std::fmax(in, out.t[0]), out.t[3]);
  out.t[2] = std::fmin(std::fmax(back, out.t[0]), out.t[3]);
  return true;
}

// The part over the triangle itself.
MORTISE_HD inline bool one_stretch(const double P[3], const double Q[3], Stretches& out) {
  const double rim[3] = {kOnSide, kOnSide, kOnSide};
  clip_segment(P, Q, rim, out.t[0], out.t[3]);
  out.t[1] = out.t[0], out.t[2] = out.t[3];
  return out.t[0] < out.t[3];
}
MORTISE_HD inline double edge_multiplicity(const Scene& s, Index slave, const Vec3& n, const double P[3], const double Q[3], const Stretches& part) {
  double out = 1;
  for (int a = 0; a < 3; ++a)
    if (std::fmax(P[a] + part.t[0] * (Q[a] - P[a]), P[a] + part.t[3] * (Q[a] - P[a])) <= kOnSide) out *= side_multiplicity(s, slave, n, a);
  return out;
}

}  // namespace mortise::effects::mortar
