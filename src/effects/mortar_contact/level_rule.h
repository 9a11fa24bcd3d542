#pragma once
// Integration of functions of the gap, without an error that would show, over a triangle on which the gap is linear (`quadrature:
// exact`). The integrand is smooth along the gap except at d_hat and bends the more the smaller the gap is, and does not change along
// lines of equal gap. So the triangle is cut into slabs between such lines, at its middle corner, at d_hat and wherever the gap has
// grown by two fifths; each slab has Gauss points across, as many as its ratio of gaps asks for, and two along. On a slab [u, v] of gaps,
// Gauss' rule of n points errs by about (z + sqrt(z^2 - 1))^-2n with z = (v + u)/(v - u), the distance of the singularity g = 0
// (Trefethen, Approximation Theory and Practice, ch. 19): below 1e-12 throughout. Integrals of b, b' N_a and b'' N_a N_b then depend on
// the polygon alone, not on how it is divided into triangles.
#include "base/jet.h"
#include "effects/mortar_contact/quadrature.h"
#include "effects/mortar_contact/tuning.h"

namespace mortise::effects::mortar {

// Gauss points on 0..1 with 2, 3 or 6 points.
MORTISE_HD inline SegmentPoint across_point(int n, int i) {
  if (n < 6) return segment_point(n, i);
  const int k = i < 3 ? i : 5 - i;
  const double x = k == 0 ? 0.93246951420315202781 : k == 1 ? 0.66120938646626451366 : 0.23861918608319690863;
  const double w = k == 0 ? 0.17132449237917034504 : k == 1 ? 0.36076157304813860757 : 0.46791393457269104739;
  return {0.5 + (i < 3 ? -0.5 : 0.5) * x, 0.5 * w};
}

// Calls slab(u, v, points) for the slabs of gaps between lo and hi, up to `reach`.
template <class T, class Slab>
MORTISE_HD inline void slabs(const T& lo, const T& mid, const T& hi, double d_hat, double reach, const Slab& slab) {
  MORTISE_ROLLED for (T u = lo; u < hi && u < reach;) {
    T v = larger(tuning::kSlabGrowth * u, u + tuning::kSlabLeast * d_hat);
    if (u < mid) v = smaller(v, mid);
    if (u < d_hat) v = smaller(v, d_hat);
    v = smaller(v, hi);
    const double z = value_of((v + u) / (v - u));
    slab(u, v, z > 1000 ? 2 : z > 60 ? 3 : 6);
    u = v;
  }
}

// As good as constant?
template <class T>
MORTISE_HD inline bool level(const T& lo, const T& hi) {
  return !(hi - lo > tuning::kLevel * hi);
}

// Calls take(t, weight) for points 0 <= t <= 1 of a segment with gaps g0 > 0 at 0 and g1 > 0 at 1; weights add up to 1, less what lies
// beyond `reach`.
template <class T, class Emit>
MORTISE_HD inline void level_segment_rule(const T& g0, const T& g1, double d_hat, double reach, const Emit& emit) {
  const T lo = smaller(g0, g1), hi = larger(g0, g1);
  if (level(lo, hi)) {
    MORTISE_ROLLED for (int q = 0; q < 2; ++q) emit(T(segment_point(2, q).t), T(segment_point(2, q).weight));
    return;
  }
  slabs(lo, lo, hi, d_hat, reach, [&](const T& u, const T& v, int n) {
    MORTISE_ROLLED for (int q = 0; q < n; ++q) {
      const SegmentPoint p = across_point(n, q);
      emit((u + p.t * (v - u) - g0) / (g1 - g0), p.weight * (v - u) / (hi - lo));
    }
  });
}

// The same for a triangle: take(b, weight) gets barycentrics. g: gaps at the corners, > 0.
template <class T, class Emit>
MORTISE_HD inline void level_rule(const T g[3], double d_hat, double reach, const Emit& emit) {
  int a = 0, b = 1, c = 2;  // corners by gap
  if (g[b] < g[a]) a = 1, b = 0;
  if (g[c] < g[a]) {
    c = b, b = a, a = 2;
  } else if (g[c] < g[b]) {
    c = b, b = 2;
  }
  const T lo = g[a], mid = g[b], hi = g[c];
  if (level(lo, hi)) {
    MORTISE_ROLLED for (int q = 0; q < 3; ++q) {
      const TrianglePoint p = triangle_point(3, q);
      const T at[3] = {p.b[0], p.b[1], p.b[2]};
      emit(at, T(p.weight));
    }
    return;
  }
  slabs(lo, mid, hi, d_hat, reach, [&](const T& u, const T& v, int n) {
    const bool below = v <= mid;
    MORTISE_ROLLED for (int q = 0; q < n; ++q) {
      const SegmentPoint p = across_point(n, q);
      const T gap = u + p.t * (v - u), t = (gap - lo) / (hi - lo);
      // From the edge (a, c) to (a, b) or (b, c); area per gap, as a share of the triangle's.
      const T s = below ? (gap - lo) / (mid - lo) : (gap - mid) / (hi - mid);
      const T density = below ? 2 * s / (hi - lo) : 2 * (1 - s) / (hi - lo);
      MORTISE_ROLLED for (int i = 0; i < 2; ++i) {
        const SegmentPoint along = segment_point(2, i);
        T at[3];
        at[a] = (1 - along.t) * (1 - t) + (below ? along.t * (1 - s) : T(0));
        at[b] = along.t * (below ? s : 1 - s);
        at[c] = (1 - along.t) * t + (below ? T(0) : along.t * s);
        emit(at, p.weight * (v - u) * density * along.weight);
      }
    }
  });
}

}  // namespace mortise::effects::mortar
