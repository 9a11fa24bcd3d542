#pragma once
// Three points of equal weight that integrate polynomials of degree 2 over a convex polygon exactly: with its centroid c and
// covariance C,
//     x_k = c + sqrt(2) C^(1/2) u_k,     u_k = (1, 0), (-1/2, sqrt(3)/2), (-1/2, -sqrt(3)/2).
// They lie on the ellipse (x - c)^T C^-1 (x - c) = 2, which every convex polygon contains (Kannan, Lovasz, Simonovits, Discrete Comput.
// Geom. 13, 1995, theorem 4.1, in two dimensions; a triangle touches it at the middles of its sides, where this is the usual rule).
// The points depend on the polygon's shape alone, not on how its corners are listed: they move smoothly when corners appear,
// vanish or lie on a side, as they do in numbers where the meshes of two bodies are aligned. A rule on a fan of triangles jumps there.
//
// A polygon's corners have places N on the slave and M on the master, M an affine function of N. With covariances C = C_NN and C_MN
//     C^(1/2) = (C + s I)/t,  s = sqrt(det C),  t = sqrt(tr C + 2 s),     offset of M = C_MN C^-1 (offset of N),  C^-1 = adj(C)/s^2.
#include <cmath>

#include "effects/mortar_contact/clip.h"

namespace mortise::effects::mortar {

template <class T>
struct MomentRule {
  T area = 0;  // in areas of the slave triangle
  CornerOf<T> at[3];
};

template <class T>
MORTISE_HD inline MomentRule<T> moment_rule(const PolygonOf<T>& p) {
  MomentRule<T> out;
  // Moments about corner 0: first[i], second[i][j] = integral of x_i x_j with x = (N1, N2, M1, M2) - corner 0.
  T first[4] = {0, 0, 0, 0}, second[4][2] = {{0, 0}, {0, 0}, {0, 0}, {0, 0}};
  const CornerOf<T>& o = p.v[0];
  MORTISE_ROLLED for (int k = 1; k + 1 < p.n; ++k) {
    const T w = fan_area(p, k);
    const CornerOf<T>&a = p.v[k], &b = p.v[k + 1];
    const T x[4] = {a.N[1] - o.N[1], a.N[2] - o.N[2], a.M[1] - o.M[1], a.M[2] - o.M[2]};
    const T y[4] = {b.N[1] - o.N[1], b.N[2] - o.N[2], b.M[1] - o.M[1], b.M[2] - o.M[2]};
    out.area += w;
    for (int i = 0; i < 4; ++i) {
      first[i] += w / 3 * (x[i] + y[i]);
      for (int j = 0; j < 2; ++j) second[i][j] += w / 12 * (x[i] * x[j] + y[i] * y[j] + (x[i] + y[i]) * (x[j] + y[j]));
    }
  }
  if (!(out.area > 0)) return out;
  T c[4], C[4][2];
  for (int i = 0; i < 4; ++i) c[i] = first[i] / out.area;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 2; ++j) C[i][j] = second[i][j] / out.area - c[i] * c[j];
  const T trace = C[0][0] + C[1][1], det = C[0][0] * C[1][1] - C[0][1] * C[1][0];
  constexpr double kSliver = 1e-12;  // det C / tr C^2 below which the polygon is a line to rounding
  const T s = det > kSliver * trace * trace ? root(det) : T(0), t = trace > 0 ? root(trace + 2 * s) : T(0);
  const double u[3][2] = {{1, 0}, {-0.5, 0.8660254037844386}, {-0.5, -0.8660254037844386}};
  MORTISE_ROLLED for (int k = 0; k < 3; ++k) {
    T x[4] = {c[0], c[1], c[2], c[3]};
    if (t > 0) {
      const T r = std::sqrt(2.0) / t;
      const double a0 = u[k][0], a1 = u[k][1];
      // C^-1 s u = adj(C) u / s
      const T b0 = s > 0 ? (C[1][1] * a0 - C[0][1] * a1) / s : T(0), b1 = s > 0 ? (C[0][0] * a1 - C[1][0] * a0) / s : T(0);
      for (int i = 0; i < 2; ++i) x[i] += r * (C[i][0] * a0 + C[i][1] * a1 + s * u[k][i]);
      for (int i = 2; i < 4; ++i) x[i] += r * (C[i][0] * (a0 + b0) + C[i][1] * (a1 + b1));
    }
    CornerOf<T>& to = out.at[k];
    to.N[1] = o.N[1] + x[0], to.N[2] = o.N[2] + x[1], to.N[0] = 1 - to.N[1] - to.N[2];
    to.M[1] = o.M[1] + x[2], to.M[2] = o.M[2] + x[3], to.M[0] = 1 - to.M[1] - to.M[2];
  }
  return out;
}

}  // namespace mortise::effects::mortar
