#pragma once
// Where two surfaces are sampled and with which weights. A sample is a pair of points, x_s = sum N_a y_a on a slave triangle and
// x_m = sum M_b y_b on a master triangle, with the gap g = n . (x_m - x_s) along the slave normal n and a weight w [m^2].
//
//   faces    Gauss points of the exactly clipped overlap (clip.h); w = current slave area of the piece.
//   edges    Gauss points of the master edge's projection within the slave triangle, shared like points.
//   points   the projection of a master vertex, shared between slave triangles near their edges.
// An edge or vertex belongs to the first master triangle that has it, so every sample lives on one pair of triangles.
//
// consistent  w of faces as it is: over a covered slave triangle sum w N_a, sum w M_b are exact, which is what the patch test
//             asks for. Edges and points are there for what faces cannot see, a ridge or a tip: their w is a third of the area of
//             the adjacent triangles T times
//                 H(min_T (1 + n . n_T) / (1 - cos 10 deg))           none where a face is parallel to the slave
//               x H(max_T (1 - c . n_T) / (1 - cos 30 deg))           none where the master is flat, next to none on the
//                                                                 facets of a curved surface; c = mean normal
//               x H(-n . c / 0.2)                                     none on the far side,
//             H(s) = 3 s^2 - 2 s^3 from 0 to 1.
// tapered     the published form (gmcp.md 1.4): faces x H(min_b M_b / e), edges x H(min(t, 1-t) / e), and edge and point weights
//             that give back what the faces lose, E6 and E7: e sum_T A_T and 0.1 e^2 sum_T A_T over the facing triangles T.
// Faces at an angle to the slave fade out: tapered between 81 and 87 degrees; consistent between 49 and 70, since a gap along the slave's
// normal says nothing about a surface that slides past at an angle, and what such faces hold between them are edges and tips.
#include <cmath>

#include "effects/contact/topology.h"
#include "effects/mortar_contact/clip.h"
#include "effects/mortar_contact/level_rule.h"
#include "effects/mortar_contact/moment_rule.h"
#include "geometry/mesh.h"
#include "geometry/quadratic.h"

namespace mortise::effects::mortar {

using device::Buffer;
using device::View;

enum class SampleKind : Index { face, edge, point };
inline constexpr int kKinds = 3;

inline constexpr Index kExact = 0;    // level_rule.h
inline constexpr Index kMoments = 3;  // moment_rule.h

struct Settings {
  double d_hat = 0;  // [m]
  double taper = 0;  // width e; 0 = consistent weights
  double share = 1;  // factor of all weights: 1/2 when both sides are slaves
  Index quadrature = 3;  // points, or kExact
  bool exact = false;     // three-term gap gradient
  bool averaged = false;  // one gap per slave node (averaged.h)
};

// The nodes that the displacement of a surface triangle hangs on: its three vertices, or the six of the quadratic face of which it is a
// quarter.
struct FaceNodes {
  Index point[6];
  int count = 0;     // 3, 6, or 0 of a half-space
  int quarter = -1;  // of a quadratic face

  // Slot of the triangle's vertex k.
  MORTISE_HD int vertex(int k) const { return quarter < 0 ? k : geometry::quarter_node(quarter, k); }
  // Shape functions of the nodes where the triangle's barycentrics are b.
  MORTISE_HD void shape(const double b[3], double w[6]) const {
    if (quarter < 0) {
      for (int k = 0; k < 3; ++k) w[k] = b[k];
      return;
    }
    double l[3];
    geometry::quarter_place(quarter, b, l);
    geometry::triangle_shape(l, w);
  }
  // Their derivatives by b1 and b2, with b0 = 1 - b1 - b2.
  MORTISE_HD void slope(const double b[3], double d1[6], double d2[6]) const {
    if (quarter < 0) {
      for (int k = 0; k < 3; ++k) d1[k] = k == 0 ? -1 : k == 1 ? 1 : 0, d2[k] = k == 0 ? -1 : k == 2 ? 1 : 0;
      return;
    }
    const double corner[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double l[3], at[3][3], by1[6], by2[6];
    geometry::quarter_place(quarter, b, l);
    for (int k = 0; k < 3; ++k) geometry::quarter_place(quarter, corner[k], at[k]);
    geometry::triangle_slope(l, by1, by2);
    for (int k = 0; k < 6; ++k) {
      d1[k] = by1[k] * (at[1][1] - at[0][1]) + by2[k] * (at[1][2] - at[0][2]);
      d2[k] = by1[k] * (at[2][1] - at[0][1]) + by2[k] * (at[2][2] - at[0][2]);
    }
  }
};

// All that a kernel reads besides positions.
struct Scene {
  Settings set;
  geometry::SurfaceView surface;  // pair_allowed: slave body x master body
  contact::TopologyView topology;
  View<const Index> law;     // bodies x (bodies + half-spaces): slave, master -> law, or -1
  View<const double> kappa;  // per law [Pa]
  View<const contact::Plane> planes;
  View<const Index> slaves;    // triangles that are slaves, environments contiguous
  View<const double> support;  // their support radius d_hat_i [m]
  View<const Vec3> normal;     // of every triangle, now
  View<const double> area;     // [m^2]
  View<const geometry::Face> faces;  // quadratic ones
  View<const Index> quarter;         // per triangle: 4 face + quarter, or -1; empty where all faces are linear
  View<const double> bow;            // and the most by which the face stands off the triangle [m]
  MORTISE_HD double bow_of(Index triangle) const { return bow.n > 0 ? bow[triangle] : 0; }
  MORTISE_HD FaceNodes nodes_of(Index triangle) const {
    const Index q = quarter.n > 0 ? quarter[triangle] : -1;
    FaceNodes out;
    out.count = q < 0 ? 3 : 6;
    out.quarter = q < 0 ? -1 : static_cast<int>(q % 4);
    for (int k = 0; k < out.count; ++k) out.point[k] = q < 0 ? surface.triangles[triangle].v[k] : faces[q / 4].v[k];
    return out;
  }
  MORTISE_HD Index law_of(Index slave_body, Index master) const { return law[slave_body * (surface.bodies + planes.n) + master]; }
};

// C1 step.
MORTISE_HD inline double hermite(double s) { return s <= 0 ? 0 : s >= 1 ? 1 : s * s * (3 - 2 * s); }
// How much a master face with normal nm counts for a slave with normal n.
MORTISE_HD inline double facing(const Settings& set, const Vec3& n, const Vec3& nm) {
  const double cosine = -n.dot(nm);
  return set.taper > 0 ? hermite((cosine - 0.05) / 0.1) : hermite((cosine - 0.35) / 0.3);
}

inline constexpr double kGate = 0.015192246987791981;  // 1 - cos 10 deg
inline constexpr double kSharp = 0.13397459621556135;  // 1 - cos 30 deg
inline constexpr double kOnSide = 1e-10;               // barycentric; a master vertex this near to a slave edge lies on it

// Weight [m^2] of a master edge or vertex whose triangles are list[begin..end); `given_back` is what E6 or E7 multiply areas by.
MORTISE_HD inline double feature_weight(const Scene& s, const Vec3& n, const View<const Index>& list, Index begin, Index end,
                                        double given_back) {
  if (s.set.taper > 0) {
    double sum = 0;
    for (Index k = begin; k < end; ++k) sum += facing(s.set, n, s.normal[list[k]]) * -n.dot(s.normal[list[k]]) * s.area[list[k]];
    return given_back * sum;
  }
  Vec3 mean = Vec3::Zero();
  double sum = 0, parallel = 2, sharp = 0;
  for (Index k = begin; k < end; ++k) {
    const Vec3 nm = s.normal[list[k]];
    mean += nm;
    sum += s.area[list[k]];
    parallel = std::fmin(parallel, 1 + n.dot(nm));
  }
  mean /= mean.norm();
  for (Index k = begin; k < end; ++k) sharp = std::fmax(sharp, 1 - mean.dot(s.normal[list[k]]));
  return sum / 3 * hermite(parallel / kGate) * hermite(sharp / kSharp) * hermite(-n.dot(mean) / 0.2);
}

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

// A face in the frame of a slave triangle: barycentrics N1, N2 and height [m] of its nodes.
struct Sheet {
  FaceNodes on;
  Vec3 c[6];
  MORTISE_HD Vec3 at(const double b[3]) const {
    double w[6];
    on.shape(b, w);
    Vec3 x = Vec3::Zero();
    for (int k = 0; k < on.count; ++k) x += w[k] * c[k];
    return x;
  }
};
// A slave triangle with the master triangles near it.
struct Patch {
  Index slave;  // triangle
  Vec3 y[3];    // its corners
  SlavePlane plane;
  double bend[3];  // below
  Sheet face;  // where the scene has quadratic faces
  double support, reach;  // samples with a gap below `reach` are wanted
  const Index* master;    // triangles
  Index masters;
};

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
  for (Index j = s.topology.edge_offset[edge]; j < s.topology.edge_offset[edge + 1]; ++j) most = std::fmax(most, 1 - n.dot(s.normal[s.topology.edge_triangle[j]]));
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

MORTISE_HD inline Sheet sheet_of(const Scene& s, const SlavePlane& plane, Index triangle, View<const Vec3> y) {
  Sheet out;
  out.on = s.nodes_of(triangle);
  for (int k = 0; k < out.on.count; ++k) {
    double N[3];
    const double height = project(plane, y[out.on.point[k]], N);
    out.c[k] = Vec3(N[1], N[2], height);
  }
  return out;
}

// Moves b to the point of the face exactly above or below x and returns that point. Quarters get b nearly right, so that Newton needs two
// or three steps.
MORTISE_HD inline Vec3 slide(const Sheet& face, const Vec3& x, double b[3]) {
  for (int step = 0;; ++step) {
    const Vec3 at = face.at(b);
    const double u = at[0] - x[0], v = at[1] - x[1];
    if (step == 5 || std::abs(u) + std::abs(v) < 1e-14) return at;
    double d1[6], d2[6];
    face.on.slope(b, d1, d2);
    Vec3 x1 = Vec3::Zero(), x2 = Vec3::Zero();
    for (int k = 0; k < face.on.count; ++k) x1 += d1[k] * face.c[k], x2 += d2[k] * face.c[k];
    const double det = x1[0] * x2[1] - x1[1] * x2[0];
    if (det == 0) return at;
    b[1] += (v * x2[0] - u * x2[1]) / det;
    b[2] += (u * x1[1] - v * x1[0]) / det;
    b[0] = 1 - b[1] - b[2];
  }
}

// No gap is taken to be smaller than this share of the support radius. Continuous collision detection keeps the quarters apart, not
// the quadratic faces themselves, which a coarse mesh could bring together between its nodes.
inline constexpr double kLeastGap = 1e-3;

// A master triangle over a patch.
struct Facing {
  Vec3 y[3];
  double L[3][3], height[3];  // slave barycentrics and heights of its corners
};
MORTISE_HD inline Facing project(const Scene& s, const SlavePlane& plane, Index master, View<const Vec3> y) {
  Facing f;
  for (int k = 0; k < 3; ++k) {
    f.y[k] = y[s.surface.triangles[master].v[k]];
    f.height[k] = project(plane, f.y[k], f.L[k]);
  }
  return f;
}

MORTISE_HD inline double height(const Facing& f, const double M[3]) {
  return M[0] * f.height[0] + M[1] * f.height[1] + M[2] * f.height[2];
}

// How much of what lies at gap g above the slave's point N master f hides: it must lie in between, and hides less and less outside of
// its rim, up to as far as the distance of the two. Stacked layers must not add up.
MORTISE_HD inline double covers(const Facing& f, const double N[3], double g) {
  const double ax = f.L[1][1] - f.L[0][1], ay = f.L[1][2] - f.L[0][2], bx = f.L[2][1] - f.L[0][1], by = f.L[2][2] - f.L[0][2];
  const double px = N[1] - f.L[0][1], py = N[2] - f.L[0][2], det = ax * by - ay * bx;
  if (det == 0) return 0;
  double M[3];
  M[1] = (px * by - py * bx) / det, M[2] = (ax * py - ay * px) / det, M[0] = 1 - M[1] - M[2];
  const double h = height(f, M);
  if (!(h > 0 && h < g)) return 0;
  return hermite(1 + rim_distance(f.y, M) / (g - h));
}
MORTISE_HD inline bool may_cover(const Scene& s, const Patch& p, Index i, Index j) {
  if (i == j || !(-p.plane.n.dot(s.normal[p.master[j]]) > 0.1)) return false;
  const Triangle a = s.surface.triangles[p.master[i]], b = s.surface.triangles[p.master[j]];
  for (int k = 0; k < 3; ++k)
    if (contact::has(a, b.v[k])) return false;  // neighbours of one surface
  return true;
}
// Bounds of a master in the slave plane and along the normal: could j hide any part of i?
MORTISE_HD inline bool boxes_overlap(const Patch& p, const Facing& i, const Facing& j) {
  const double top = std::fmax(i.height[0], std::fmax(i.height[1], i.height[2])),
               floor = std::fmin(j.height[0], std::fmin(j.height[1], j.height[2]));
  if (!(floor < top)) return false;
  for (int c = 0; c < 3; ++c) {
    const auto lo = [c](const Facing& f) { return std::fmin(f.L[0][c], std::fmin(f.L[1][c], f.L[2][c])); };
    const auto hi = [c](const Facing& f) { return std::fmax(f.L[0][c], std::fmax(f.L[1][c], f.L[2][c])); };
    const double strip = (top - floor) / p.plane.altitude(c);  // covers() fades over no more
    if (!(lo(i) < hi(j) + strip && lo(j) < hi(i) + strip)) return false;
  }
  return true;
}
MORTISE_HD inline bool any_layer(const Scene& s, const Patch& p, Index i, const Facing& f, View<const Vec3> y) {
  for (Index j = 0; j < p.masters; ++j)
    if (may_cover(s, p, i, j) && boxes_overlap(p, f, project(s, p.plane, p.master[j], y))) return true;
  return false;
}
// Share of what master i shows at N that no other master hides.
MORTISE_HD inline double visible(const Scene& s, const Patch& p, Index i, View<const Vec3> y, const double N[3], double g) {
  double hidden = 0;
  for (Index j = 0; j < p.masters; ++j)
    if (may_cover(s, p, i, j)) hidden += covers(project(s, p.plane, p.master[j], y), N, g);
  return hidden < 1 ? 1 - hidden : 0;
}

// Calls at(b, weight) for the points of a triangle whose corners have these gaps; weights add up to 1.
template <class At>
MORTISE_HD inline void integrate(const Scene& s, const double gap[3], const Patch& p, const At& at) {
  if (s.set.quadrature == kExact && gap[0] > 0 && gap[1] > 0 && gap[2] > 0) {
    level_rule(gap, p.support, p.reach, at);
    return;
  }
  const int n = s.set.quadrature == kExact ? 7 : s.set.quadrature;
  for (int q = 0; q < n; ++q) {
    const TrianglePoint g = triangle_point(n, q);
    at(g.b, g.weight);
  }
}

// Three points for what of a polygon lies within the support radius, and three for what lies within reach beyond it: a strip that just
// comes near is seen, however narrow. The barrier ends so smoothly (b ~ (1 - t)^3) that cutting there adds nothing to derivatives.
// `gap` at a corner; at(corner, share of the slave triangle's area).
template <class Gap, class At>
MORTISE_HD inline void integrate_levels(const Patch& p, const Polygon& whole, const Gap& gap, const At& at) {
  const auto nothing = [](Corner&) {};
  double least = INFINITY, most = -INFINITY;
  for (int k = 0; k < whole.n; ++k) least = std::fmin(least, gap(whole.v[k])), most = std::fmax(most, gap(whole.v[k]));
  for (int part = 0; part < 2; ++part) {
    const double lo = part == 0 ? -INFINITY : p.support, hi = part == 0 ? p.support : p.reach;
    if (!(lo < hi && least < hi && most > lo)) continue;
    Polygon poly = whole;
    if (least < lo) poly = keep(poly, [&](const Corner& c) { return gap(c) - lo; }, nothing);
    if (most > hi) poly = keep(poly, [&](const Corner& c) { return hi - gap(c); }, nothing);
    const MomentRule rule = moment_rule(poly);
    for (int q = 0; q < 3 && rule.share > 0; ++q) at(rule.at[q], rule.share / 3);
  }
}

// The same along a segment with gaps g0 and g1 at its ends: at(t, weight).
template <class At>
MORTISE_HD inline void integrate_segment(const Scene& s, double g0, double g1, const Patch& p, const At& at) {
  if (s.set.quadrature == kExact && g0 > 0 && g1 > 0) {
    level_segment_rule(g0, g1, p.support, p.reach, at);
    return;
  }
  const int n = segment_points(s.set.quadrature);
  for (int q = 0; q < n; ++q) {
    const SegmentPoint g = segment_point(n, q);
    at(g.t, g.weight);
  }
}

// Calls take(kind, weight, gap, N, M) for every sample on master i of the patch.
template <class Take>
MORTISE_HD inline void sample_master(const Scene& s, const Patch& p, Index i, View<const Vec3> y, Take& take) {
  const Index master = p.master[i];
  const Vec3 n = p.plane.n;
  const double fade = facing(s.set, n, s.normal[master]);
  const Facing f = project(s, p.plane, master, y);
  const double lowest = std::fmin(f.height[0], std::fmin(f.height[1], f.height[2]));
  const double highest = std::fmax(f.height[0], std::fmax(f.height[1], f.height[2]));
  const double reach = p.reach + s.bow_of(p.slave) + s.bow_of(master);
  if (!(lowest < reach && highest > 0)) return;
  int layers = -1;  // do others lie in between? Looked up when a sample first asks
  Sheet face;
  if (s.quarter.n > 0) face = sheet_of(s, p.plane, master, y);
  const bool bent = p.face.on.quarter >= 0 || face.on.quarter >= 0;
  const double e = s.set.taper;
  const auto offer = [&](SampleKind kind, double weight, double N[3], double M[3]) {
    double gap = height(f, M);  // of the quarters, which cannot meet
    if (!(gap > 0 && gap < reach)) return;
    if (layers < 0) layers = any_layer(s, p, i, f, y);
    if (layers) weight *= visible(s, p, i, y, N, gap);
    if (!(weight > 0)) return;
    if (bent) {
      // Faces are sampled at points of the slave, ridges and tips at their own.
      const bool of_slave = kind == SampleKind::face;
      const Vec3 fixed = of_slave ? p.face.at(N) : face.at(M);
      const Vec3 found = of_slave ? slide(face, fixed, M) : slide(p.face, fixed, N);
      gap = std::fmax(of_slave ? found[2] - fixed[2] : fixed[2] - found[2], kLeastGap * p.support);
    }
    if (gap < p.reach) take(kind, weight, gap, N, M);
  };

  if (fade > 0) {
    const Polygon poly = clip(f.L);
    const bool whole = s.set.quadrature == kMoments && e == 0;
    if (whole) {
      // Faces that are next to parallel are cut where they leave the support radius. At an angle the strips within are narrow, and of a
      // gap that a step only seems to close, as above.
      const double cut = bent ? 0 : hermite((-n.dot(s.normal[master]) - 0.97) / 0.015);
      const double area = s.set.share * fade * p.plane.area;
      const auto at = [&](Corner c, double w) { offer(SampleKind::face, area * w, c.N, c.M); };
      if (cut > 0) integrate_levels(p, poly, [&](const Corner& c) { return height(f, c.M); }, [&](const Corner& c, double w) { at(c, cut * w); });
      const MomentRule rule = moment_rule(poly);
      for (int q = 0; q < 3 && cut < 1 && rule.share > 0; ++q) at(rule.at[q], (1 - cut) * rule.share / 3);
    }
    for (int k = 1; k + 1 < poly.n && !whole; ++k) {
      const double w = fade * p.plane.area * fan_share(poly, k);
      if (!(w > 0)) continue;
      const Corner* c[3] = {&poly.v[0], &poly.v[k], &poly.v[k + 1]};
      const auto at = [&](const double b[3], double weight) {
        double N[3], M[3];
        for (int a = 0; a < 3; ++a) {
          N[a] = b[0] * c[0]->N[a] + b[1] * c[1]->N[a] + b[2] * c[2]->N[a];
          M[a] = b[0] * c[0]->M[a] + b[1] * c[1]->M[a] + b[2] * c[2]->M[a];
        }
        const double taper = e > 0 ? hermite(std::fmin(M[0], std::fmin(M[1], M[2])) / e) : 1;
        if (taper > 0) offer(SampleKind::face, s.set.share * w * weight * taper, N, M);
      };
      const double corner[3] = {height(f, c[0]->M), height(f, c[1]->M), height(f, c[2]->M)};
      integrate(s, corner, p, at);
    }
  }

  for (int k = 0; k < 3; ++k) {
    const int l = k < 2 ? k + 1 : 0;
    const Index edge = s.topology.triangle_edge[3 * master + k];
    const Index begin = s.topology.edge_offset[edge], end = s.topology.edge_offset[edge + 1];
    const double top = std::fmin(std::fmax(f.height[k], f.height[l]), p.reach);
    if (s.topology.edge_triangle[begin] != master || !(top > 0)) continue;
    Stretches stretch;
    if (!(e > 0 ? one_stretch(f.L[k], f.L[l], stretch) : stretches(p, f.L[k], f.L[l], top, stretch))) continue;
    double w = s.set.share * feature_weight(s, n, s.topology.edge_triangle, begin, end, e);
    if (!(w > 0)) continue;
    if (e > 0) w *= edge_multiplicity(s, p.slave, n, f.L[k], f.L[l], stretch);
    for (int part = 0; part < 3; ++part) {
      const double t0 = stretch.t[part], t1 = stretch.t[part + 1];
      if (!(t1 > t0)) continue;
      const auto at = [&](double along, double weight) {
        const double t = t0 + along * (t1 - t0), taper = e > 0 ? hermite(std::fmin(t, 1 - t) / e) : 1;
        double N[3], M[3] = {0, 0, 0};
        M[k] = 1 - t, M[l] = t;
        for (int a = 0; a < 3; ++a) N[a] = (1 - t) * f.L[k][a] + t * f.L[l][a];
        const double shared = e > 0 ? 1 : belongs(p, N, height(f, M));
        if (taper * shared > 0) offer(SampleKind::edge, w * (t1 - t0) * weight * taper * shared, N, M);
      };
      const double rise = f.height[l] - f.height[k];
      integrate_segment(s, f.height[k] + t0 * rise, f.height[k] + t1 * rise, p, at);
    }
  }

  for (int k = 0; k < 3; ++k) {
    const Index v = s.surface.triangles[master].v[k];
    const Index begin = s.topology.point_offset[v], end = s.topology.point_offset[v + 1];
    if (s.topology.point_triangle[begin] != master) continue;
    double N[3] = {f.L[k][0], f.L[k][1], f.L[k][2]};
    const double shared = e > 0 ? (N[0] >= -kOnSide && N[1] >= -kOnSide && N[2] >= -kOnSide ? multiplicity(s, p.slave, n, N) : 0) : belongs(p, N, f.height[k]);
    if (!(shared > 0)) continue;
    const double w = s.set.share * shared * feature_weight(s, n, s.topology.point_triangle, begin, end, 0.1 * e * e);
    double M[3] = {0, 0, 0};
    M[k] = 1;
    if (w > 0) offer(SampleKind::point, w, N, M);
  }
}

// Against a half-space: g = n_p . (x_s - p), exact for every point of the slave; w = slave area projected onto the plane.
template <class Take>
MORTISE_HD inline void sample_plane(const Scene& s, const Patch& p, const contact::Plane& plane, View<const Vec3> y, Take& take) {
  const double cosine = -p.plane.n.dot(plane.normal);
  if (!(cosine > 0)) return;
  const FaceNodes on = s.nodes_of(p.slave);
  double h[6], w[6];
  for (int k = 0; k < on.count; ++k) h[k] = plane.normal.dot(y[on.point[k]] - plane.point);
  const double M[3] = {0, 0, 0};
  const auto at = [&](const double b[3], double weight) {
    on.shape(b, w);
    double gap = 0;
    for (int k = 0; k < on.count; ++k) gap += w[k] * h[k];
    if (on.quarter >= 0) gap = std::fmax(gap, kLeastGap * p.support);
    if (gap > 0 && gap < p.reach) take(SampleKind::face, s.set.share * cosine * p.plane.area * weight, gap, b, M);
  };
  const double corner[3] = {h[on.vertex(0)], h[on.vertex(1)], h[on.vertex(2)]};
  if (s.set.quadrature == kMoments && s.set.taper == 0 && on.quarter < 0) {
    Polygon triangle;
    for (int k = 2; k >= 0; --k) triangle.push({{k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0}, {0, 0, 0}});  // turns like a master
    integrate_levels(p, triangle, [&](const Corner& c) { return c.N[0] * corner[0] + c.N[1] * corner[1] + c.N[2] * corner[2]; },
                     [&](const Corner& c, double share) { at(c.N, share); });
    return;
  }
  integrate(s, corner, p, at);
}

}  // namespace mortise::effects::mortar
