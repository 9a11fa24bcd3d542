#pragma once
// Closest points of point-triangle and edge-edge pairs, and the squared distance
//     D(x) = |r|^2,   r = sum_i w_i x_i,   sum_i w_i = 0
// with its derivatives. Every feature type is one case of: r is affine in the free parameters beta of the closest point,
//     w(beta) = w + sum_k beta_k w'_k,   e_k = sum_i w'_{k,i} x_i   (tangents),   G_kl = e_k . e_l,
// and D is the minimum over beta. With r . e_k = 0 there, implicit differentiation gives (blocks of 3 per vertex)
//     grad D = 2 w (x) r,     Hess D = 2 [ w w^T (x) I - B G^-1 B^T ],     B_k = w'_k (x) r + w (x) e_k.
#include <cmath>
#include <cstdint>

#include "base/types.h"
#include "geometry/collide/tuning.h"

namespace mortise::geometry {

enum class Feature : std::uint8_t { point_point, point_edge, point_triangle, edge_edge };

struct Closest {
  Feature type = Feature::point_point;
  int free = 0;          // number of free parameters beta: 0, 1 or 2
  double w[4] = {};      // weights of the vertices in r, first primitive positive
  double dw[2][4] = {};  // w'_k
  double squared = 0;    // D [m^2]
};

// r relative to the first vertex, so that the error is relative to the size of the pair, not to its place in the world.
MORTISE_HD inline Vec3 combine(const double w[4], const Vec3 x[4]) { return w[1] * (x[1] - x[0]) + w[2] * (x[2] - x[0]) + w[3] * (x[3] - x[0]); }
MORTISE_HD inline Vec3 relative_position(const Closest& c, const Vec3 x[4]) { return combine(c.w, x); }

namespace detail {

// Closest point of segment [x_i, x_j] to x_p; `sign` is the sign of p's weight. Keeps the result if it is nearer than c.
MORTISE_HD inline void nearer_on_segment(const Vec3 x[4], int p, int i, int j, double sign, Closest& c) {
  const Vec3 u = x[j] - x[i];
  const double uu = u.squaredNorm(), s = (x[p] - x[i]).dot(u);
  const bool inside = s > 0 && s < uu;
  double w[4] = {}, squared;
  w[p] = sign;
  if (!(s > 0)) {
    w[i] = -sign;
    squared = (x[p] - x[i]).squaredNorm();
  } else if (!inside) {
    w[j] = -sign;
    squared = (x[p] - x[j]).squaredNorm();
  } else {
    const double t = s / uu;
    w[i] = -sign * (1 - t), w[j] = -sign * t;
    squared = combine(w, x).squaredNorm();
  }
  if (!(squared < c.squared)) return;
  c = Closest{};
  c.squared = squared;
  for (int k = 0; k < 4; ++k) c.w[k] = w[k];
  if (!inside) return;
  c.type = Feature::point_edge, c.free = 1;
  c.dw[0][i] = sign, c.dw[0][j] = -sign;
}

}  // namespace detail

// x = {p, t0, t1, t2}; r = p - (l0 t0 + l1 t1 + l2 t2). Degenerate triangles fall back to their edges.
MORTISE_HD inline Closest closest_point_triangle(const Vec3 x[4]) {
  const Vec3 e1 = x[2] - x[1], e2 = x[3] - x[1], q = x[0] - x[1];
  const Vec3 n = e1.cross(e2);
  const double nn = n.squaredNorm();
  Closest c;
  c.squared = INFINITY;
  if (nn > tuning::kParallel * e1.squaredNorm() * e2.squaredNorm()) {
    const double l1 = q.cross(e2).dot(n) / nn, l2 = e1.cross(q).dot(n) / nn, l0 = 1 - l1 - l2;
    if (l0 > 0 && l1 > 0 && l2 > 0) {
      c.type = Feature::point_triangle;
      c.free = 2;
      c.w[0] = 1, c.w[1] = -l0, c.w[2] = -l1, c.w[3] = -l2;
      c.dw[0][1] = 1, c.dw[0][2] = -1;
      c.dw[1][1] = 1, c.dw[1][3] = -1;
      c.squared = combine(c.w, x).squaredNorm();
      return c;
    }
  }
  detail::nearer_on_segment(x, 0, 1, 2, 1, c);
  detail::nearer_on_segment(x, 0, 2, 3, 1, c);
  detail::nearer_on_segment(x, 0, 3, 1, 1, c);
  return c;
}

// x = {a0, a1, b0, b1}; r = (1-s) a0 + s a1 - (1-t) b0 - t b1. The crossing of the lines is taken only where it lies inside both
// edges and is nearer than all four end points, which also settles (nearly) parallel edges.
MORTISE_HD inline Closest closest_edge_edge(const Vec3 x[4]) {
  Closest c;
  c.squared = INFINITY;
  detail::nearer_on_segment(x, 0, 2, 3, 1, c);
  detail::nearer_on_segment(x, 1, 2, 3, 1, c);
  detail::nearer_on_segment(x, 2, 0, 1, -1, c);
  detail::nearer_on_segment(x, 3, 0, 1, -1, c);
  const Vec3 u = x[1] - x[0], v = x[3] - x[2], q = x[2] - x[0];
  const Vec3 n = u.cross(v);
  const double nn = n.squaredNorm();
  if (!(nn > tuning::kParallel * u.squaredNorm() * v.squaredNorm())) return c;
  const double s = q.cross(v).dot(n) / nn, t = q.cross(u).dot(n) / nn;
  if (!(s > 0 && s < 1 && t > 0 && t < 1)) return c;
  const double w[4] = {1 - s, s, t - 1, -t};
  const double squared = combine(w, x).squaredNorm();
  if (!(squared <= c.squared)) return c;
  c = Closest{};
  c.type = Feature::edge_edge;
  c.free = 2;
  for (int i = 0; i < 4; ++i) c.w[i] = w[i];
  c.dw[0][0] = -1, c.dw[0][1] = 1;
  c.dw[1][2] = 1, c.dw[1][3] = -1;
  c.squared = squared;
  return c;
}

// grad D, blocks in the order of x.
MORTISE_HD inline Vec12 distance_gradient(const Closest& c, const Vec3 x[4]) {
  const Vec3 r = relative_position(c, x);
  Vec12 g;
  for (int i = 0; i < 4; ++i) g.segment<3>(3 * i) = 2 * c.w[i] * r;
  return g;
}

// Hess D. G is regular for every type that the classification returns.
MORTISE_HD inline Mat12 distance_hessian(const Closest& c, const Vec3 x[4]) {
  const Vec3 r = relative_position(c, x);
  Vec12 B[2];
  double inverse[2][2] = {};  // G^-1
  if (c.free > 0) {
    const Vec3 e0 = combine(c.dw[0], x), e1 = combine(c.dw[1], x);
    for (int i = 0; i < 4; ++i) {
      B[0].segment<3>(3 * i) = c.dw[0][i] * r + c.w[i] * e0;
      B[1].segment<3>(3 * i) = c.dw[1][i] * r + c.w[i] * e1;
    }
    if (c.free == 1) {
      inverse[0][0] = 1 / e0.squaredNorm();
    } else {
      const double det = e0.cross(e1).squaredNorm();  // det G, without its cancellation
      inverse[0][0] = e1.squaredNorm() / det;
      inverse[1][1] = e0.squaredNorm() / det;
      inverse[0][1] = inverse[1][0] = -e0.dot(e1) / det;
    }
  }
  Mat12 H;
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) {
      double h = i % 3 == j % 3 ? c.w[i / 3] * c.w[j / 3] : 0;
      for (int k = 0; k < c.free; ++k)
        for (int l = 0; l < c.free; ++l) h -= inverse[k][l] * B[k][i] * B[l][j];
      H(i, j) = 2 * h;
    }
  return H;
}

}  // namespace mortise::geometry
