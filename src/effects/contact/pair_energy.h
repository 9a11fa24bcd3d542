#pragma once
// The contact energy of the whole surface and how its terms are weighted.
//
// area_weighted: each vertex x of a surface is a quadrature point of the contact area with b at the largest value over the facing
// surface. The improved max approximation (Li, Kaufman, Jiang 2023) writes that maximum as an alternating sum over the facing
// surface's simplices s, which is smooth where the closest feature changes:
//     max b  ~  sum_triangles b(d(x,t)) - sum_edges (k_e - 1) b(d(x,e)) + sum_vertices (1 + n_t(v) - n_e(v)) b(d(x,v))
// with k_e triangles at edge e, and n_t, n_e triangles and edges at vertex v: 1 and 1 on a closed surface, 0 at a boundary. Where
// all of them share one closest point the coefficients add up to 1, whichever feature is closest. Both surfaces are integrated
// with weight A_x/2, so that two flat facing surfaces carry 1/2 A + 1/2 A = A. A_x is the area with which x faces its contact,
//     A_x = sum over its triangles T of A_T/3 max(0, -n_T . n)      (rest areas A_T; n points out of the other surface),
// with the normals at the start of the step, and A_v = sum A_T/3 for a vertex that was out of range then. So a vertex on the rim
// of a flat face counts with its share of that face only. Constant during a step: the energy is a function of positions alone.
// Edge pairs are no quadrature of that area: how many edges of two meshes cross says nothing about the area between them.
// Counting them with an area (the 1/4 + 1/4 split of the paper) makes the total depend on the meshes. Here point-triangle terms
// carry the whole area, and edge pairs are a guard with weight (A_e + A_e')/4 and a range of d_hat/4: they keep edges apart,
// carry what only edges can carry, and are inactive in face contact up to p = phi(1/4) kappa = 4.3 kappa.
//
// Self-contact: a body's surface must not push itself apart as it is at rest, across a thin plate or between neighbouring triangles. So
// where a body meets itself, the range is at most half of the distance at rest: of a point, to all triangles of its body but its own
// (one range per point, so that the terms of the alternating sum still cancel); of two edges, between them.
//
// classic: every point-triangle pair and every edge pair within d_hat has the same weight d_hat^2 (IPC 2020, without areas): the
// energy of a pair is kappa d_hat^2 b(d), that is, a classic barrier -(d - d_hat)^2 ln(d/d_hat) with stiffness kappa d_hat [N/m].
#include "effects/contact/stencil.h"
#include "effects/contact/topology.h"
#include "effects/contact/tuning.h"
#include "geometry/collide/broadphase.h"
#include "geometry/collide/mollifier.h"

namespace mortise::effects::contact {

using geometry::EdgeEdge;
using geometry::PointTriangle;

struct BarrierParams {
  double edge_share = 1;  // range of edge pairs, as a share of d_hat
  bool area_weighted = true;
};

// All that a kernel reads besides positions.
struct BarrierView {
  BarrierParams barrier;
  View<const double> d_hats;  // per environment: range of points against triangles and half-spaces [m]
  View<const double> kappas;  // [Pa]
  geometry::SurfaceView surface;
  TopologyView topology;
  View<const Vec3> rest;             // rest positions of the points
  View<const std::uint8_t> watched;  // per pair (surface.pairs) of bodies, and of half-spaces
  View<const Plane> planes;
  View<const double> self_range;  // range of every point towards its own body [m]; empty where no body sees itself
  View<const double> point_area;  // A_x of every point [m^2]
  View<const double> plane_area;  // the same towards half-spaces: planes x surface vertices [m^2]
  MORTISE_HD double d_hat(Index point) const { return d_hats[surface.env[point]]; }
  MORTISE_HD double kappa(Index point) const { return kappas[surface.env[point]]; }
  MORTISE_HD bool sees(Index a, Index b) const { return watched[surface.pairs.of(surface.body[a], surface.body[b])] != 0; }
  MORTISE_HD bool sees_plane(Index point, Index plane) const {
    return watched[surface.pairs.of(surface.body[point], surface.pairs.bodies + plane)] != 0;
  }
};

// Coefficient of (point, edge) in the alternating sum, handed to the one triangle that accounts for it: the first at the edge
// that does not hold the point itself (self-contact sees the surface without the point's own triangles). 0 for the others.
MORTISE_HD inline Index edge_coefficient(const BarrierView& s, Index point, Index edge, Index triangle) {
  Index count = 0, owner = -1;
  for (Index k = s.topology.edge_offset[edge]; k < s.topology.edge_offset[edge + 1]; ++k) {
    const Index t = s.topology.edge_triangle[k];
    if (has(s.surface.triangles[t], point)) continue;
    if (owner < 0) owner = t;
    ++count;
  }
  return owner == triangle ? 1 - count : 0;
}
// The same for (point, vertex).
MORTISE_HD inline Index vertex_coefficient(const BarrierView& s, Index point, Index vertex, Index triangle) {
  Index count = 0, owner = -1, own = 0;
  for (Index k = s.topology.point_offset[vertex]; k < s.topology.point_offset[vertex + 1]; ++k) {
    const Index t = s.topology.point_triangle[k];
    if (has(s.surface.triangles[t], point)) {
      own = 1;  // the edge between the two goes too
      continue;
    }
    if (owner < 0) owner = t;
    ++count;
  }
  return owner == triangle ? 1 + count - (s.topology.point_edges[vertex] - own) : 0;
}

MORTISE_HD inline Closest closest_on_segment(const Vec3 x[4], int i, int j) {
  Closest c;
  c.squared = INFINITY;
  geometry::detail::nearer_on_segment(x, 0, i, j, 1, c);
  return c;
}

MORTISE_HD inline void gather(View<const Vec3> y, const Index v[4], Vec3 x[4]) {
  for (int i = 0; i < 4; ++i) x[i] = y[v[i] < 0 ? v[0] : v[i]];
}

// Range of a point towards a primitive with the corner `other`.
MORTISE_HD inline double point_range(const BarrierView& s, Index point, Index other) {
  return s.surface.body[point] == s.surface.body[other] ? s.self_range[point] : s.d_hat(point);
}
// Range of two edges {a0, a1, b0, b1}.
MORTISE_HD inline double edge_range(const BarrierView& s, const Index v[4]) {
  const double range = s.barrier.edge_share * s.d_hat(v[0]);
  if (s.surface.body[v[0]] != s.surface.body[v[2]]) return range;
  Vec3 rest[4];
  gather(s.rest, v, rest);
  const double own = tuning::kSelfRange * std::sqrt(geometry::closest_edge_edge(rest).squared);
  return own < range ? own : range;
}

// A_x of a vertex towards a contact with normal n (above). At least 1 % of A_v, so that nothing can slip through unweighted.
MORTISE_HD inline double facing_area(const BarrierView& s, Index point, const Vec3& n, View<const Vec3> y) {
  double sum = 0;
  for (Index k = s.topology.point_offset[point]; k < s.topology.point_offset[point + 1]; ++k) {
    const Triangle t = s.surface.triangles[s.topology.point_triangle[k]];
    const Vec3 now = (y[t.v[1]] - y[t.v[0]]).cross(y[t.v[2]] - y[t.v[0]]);
    const Vec3 rest = (s.rest[t.v[1]] - s.rest[t.v[0]]).cross(s.rest[t.v[2]] - s.rest[t.v[0]]);
    const double facing = -now.dot(n) / now.norm();
    if (facing > 0) sum += facing * rest.norm() / 6;
  }
  const double least = 0.01 * s.surface.vertex_area[point];
  return sum > least ? sum : least;
}

MORTISE_HD inline double point_weight(const BarrierView& s, Index point) {
  return s.barrier.area_weighted ? s.point_area[point] / 2 : s.d_hat(point) * s.d_hat(point);
}
MORTISE_HD inline double edge_weight(const BarrierView& s, const EdgeEdge& pair) {
  return s.barrier.area_weighted ? (s.surface.edge_area[pair.a] + s.surface.edge_area[pair.b]) / 4 : s.d_hat(pair.v[0]) * s.d_hat(pair.v[0]);
}

// Energy of one candidate [J]; +infinity at distance 0.
MORTISE_HD inline double pair_energy(const BarrierView& s, const PointTriangle& pair, View<const Vec3> y) {
  if (!s.sees(pair.v[0], pair.v[1])) return 0;
  const double range = point_range(s, pair.v[0], pair.v[1]), range2 = range * range;
  Vec3 x[4];
  gather(y, pair.v, x);
  const double D = geometry::closest_point_triangle(x).squared;
  if (!(D > 0)) return INFINITY;
  if (!(D < range2)) return 0;
  double sum = barrier::value(std::sqrt(D), range);
  if (s.barrier.area_weighted) {
    for (int k = 0; k < 3; ++k) {
      const Index c = edge_coefficient(s, pair.point, s.topology.triangle_edge[3 * pair.triangle + k], pair.triangle);
      if (c == 0) continue;
      const double De = closest_on_segment(x, 1 + k, 1 + (k + 1) % 3).squared;
      if (De < range2) sum += c * barrier::value(std::sqrt(De), range);
    }
    for (int k = 0; k < 3; ++k) {
      const double Dv = (x[0] - x[1 + k]).squaredNorm();
      if (!(Dv < range2)) continue;
      const Index c = vertex_coefficient(s, pair.point, pair.v[1 + k], pair.triangle);
      if (c != 0) sum += c * barrier::value(std::sqrt(Dv), range);
    }
  }
  return s.kappa(pair.point) * point_weight(s, pair.point) * sum;
}

MORTISE_HD inline double pair_energy(const BarrierView& s, const EdgeEdge& pair, View<const Vec3> y) {
  if (!s.sees(pair.v[0], pair.v[2])) return 0;
  Vec3 x[4], rest[4];
  gather(y, pair.v, x);
  const double D = geometry::closest_edge_edge(x).squared, range = edge_range(s, pair.v);
  if (!(D > 0)) return INFINITY;
  if (!(D < range * range)) return 0;
  gather(s.rest, pair.v, rest);
  const double m = geometry::mollifier(x, geometry::mollifier_threshold(rest));
  return s.kappa(pair.v[0]) * edge_weight(s, pair) * m * barrier::value(std::sqrt(D), range);
}

// i counts planes x surface vertices.
MORTISE_HD inline bool plane_pair(const BarrierView& s, Index i, View<const Vec3> y, Index& plane, Index& point, double& gap) {
  plane = i / s.surface.vertices.n;
  point = s.surface.vertices[i % s.surface.vertices.n];
  if (!s.sees_plane(point, plane)) return false;
  gap = s.planes[plane].normal.dot(y[point] - s.planes[plane].point);
  return gap < s.d_hat(point);
}
MORTISE_HD inline double plane_weight(const BarrierView& s, Index i, Index point) {
  return s.barrier.area_weighted ? s.plane_area[i] : s.d_hat(point) * s.d_hat(point);
}

MORTISE_HD inline double plane_energy(const BarrierView& s, Index i, View<const Vec3> y) {
  Index plane, point;
  double gap;
  if (!plane_pair(s, i, y, plane, point, gap)) return 0;
  if (!(gap > 0)) return INFINITY;
  return s.kappa(point) * plane_weight(s, i, point) * barrier::value(gap, s.d_hat(point));
}

}  // namespace mortise::effects::contact
