#pragma once
// Conservative continuous collision detection of x(t) = x0 + t (x1 - x0). Both pair types are one problem: the differences of
// their vertices, q(t), are the corners of a planar convex polygon (three for point-triangle, four for edge-edge), and the pair
// is as far apart as that polygon from the origin. Two certificates, both with bounds on the rounding of doubles:
//   * advance: a direction d separates while every corner has d.q(t) > distance; d.q is linear in t, so the first corner to fall
//     below tells how far d lasts, and a new d is taken there (conservative advancement, cf. Li et al. 2021 "CIPC" sec. 5 for
//     the additive variant; a direction instead of a bound on speed lets pairs that slide or separate pass in one step);
//   * inclusion: subdivision of (t, u, v) with the bounds of the multilinear difference (Wang et al. 2021, "A large-scale
//     benchmark and an inclusion-based algorithm for CCD"), for what the first leaves undecided.
#include "geometry/collide/distance.h"
#include "geometry/collide/tuning.h"

namespace mortise::geometry {

inline constexpr double kNoImpact = 2;  // "no impact in [0, 1]"

namespace detail {

inline constexpr double kEps = 2.220446049250313e-16;

struct Corners {
  Vec3 from[4], to[4];  // q(0), q(1); every component is one rounded subtraction
  int n = 0;
  bool edges = false;
  double size = 0;  // largest |q| at either end, NaN if anything is
};

// The polygon of a pair; corner 0, 1, 2 = value at (u, v) = (0, 0), (1, 0), (0, 1).
MORTISE_HD inline Corners corners(const Vec3 x0[4], const Vec3 x1[4], bool edges) {
  Corners c;
  c.edges = edges;
  c.n = edges ? 4 : 3;
  for (int k = 0; k < c.n; ++k) {
    const int i = edges && (k == 1 || k == 3) ? 1 : 0;  // vertex of the first primitive
    const int j = edges ? (k < 2 ? 2 : 3) : k + 1;      // and of the second
    c.from[k] = x0[i] - x0[j];
    c.to[k] = x1[i] - x1[j];
    const double a = c.from[k].squaredNorm(), b = c.to[k].squaredNorm();
    if (a > c.size || a != a) c.size = a;  // a NaN stays
    if (b > c.size || b != b) c.size = b;
  }
  c.size = std::sqrt(c.size);
  return c;
}

// min over corners of d . q(t)
MORTISE_HD inline double separation(const Corners& c, const Vec3& d, double t) {
  double least = INFINITY;
  for (int k = 0; k < c.n; ++k) {
    const double a = d.dot(c.from[k]), b = d.dot(c.to[k]), f = a + t * (b - a);
    if (!(f >= least)) least = f;
  }
  return least;
}

// The largest time, at most t_max, until which d keeps every corner above `level`, given that it does at t.
MORTISE_HD inline double lasts_until(const Corners& c, const Vec3& d, double level, double t_max) {
  double until = t_max;
  for (int k = 0; k < c.n; ++k) {
    const double a = d.dot(c.from[k]), b = d.dot(c.to[k]);
    if (b < a && b < level) {
      const double t = (a - level) / (a - b);
      if (!(t >= until)) until = t;
    }
  }
  return until;
}

// Unit direction from the second primitive to the first at time t, the one of the two candidates that separates better: the
// line of closest points, or the common normal, which stays accurate when the primitives all but touch.
MORTISE_HD inline Vec3 separating_direction(const Corners& c, const Vec3 x0[4], const Vec3 x1[4], double t, double& gap) {
  Vec3 x[4];
  for (int i = 0; i < 4; ++i) {
    const Vec3 from = x0[i] - x0[0], to = x1[i] - x0[0];
    x[i] = from + t * (to - from);
  }
  const Closest near = c.edges ? closest_edge_edge(x) : closest_point_triangle(x);
  const Vec3 r = relative_position(near, x);
  const double distance = r.norm();
  Vec3 d = distance > 0 ? Vec3(r / distance) : Vec3(1, 0, 0);
  gap = separation(c, d, t);
  if (near.free == 2 && !(distance > 1e-6 * c.size)) {
    Vec3 n = combine(near.dw[0], x).cross(combine(near.dw[1], x));
    n /= n.norm();
    if (n.dot(r) < 0) n = -n;
    double other = separation(c, n, t);
    if (distance == 0 && separation(c, -n, t) > other) n = -n, other = separation(c, n, t);
    if (other > gap) gap = other, d = n;
  }
  return d;
}

// Until when the distance certainly stays above `distance`: kNoImpact, or a time <= t_max after which nothing is known; `excess`
// is how far above it the distance still is then. Ends when the excess is at most `close`.
MORTISE_HD inline double advance(const Corners& c, const Vec3 x0[4], const Vec3 x1[4], double distance, double t_max, double close, double rounding,
                                 int iterations, double& excess) {
  double t = 0;
  for (int i = 0; i < iterations; ++i) {
    double gap = 0;
    const Vec3 d = separating_direction(c, x0, x1, t, gap);
    excess = gap - distance - rounding;
    if (!(excess > close)) return t;
    const double next = lasts_until(c, d, distance + rounding, t_max);
    if (next >= t_max) return kNoImpact;
    if (!(next > t)) return t;
    t = next;
  }
  return t;
}

// d.q: three products and sums of components that are themselves rounded, the interpolation in t, and the division for t.
MORTISE_HD inline double advance_rounding(const Corners& c) { return 16 * kEps * c.size; }

// Widest interval box still to be searched: lower ends and widths in (t, u, v).
struct Cell {
  double lo[3], width[3];
};

// Earliest time in [t_begin, t_max] at which the polygon may come within `distance` of the origin (per axis), to a resolution of
// `tolerance` in space; kNoImpact if it certainly does not. When the iterations run out, the earliest time still undecided.
MORTISE_HD inline double inclusion(const Corners& c, double distance, double t_begin, double t_max, double tolerance, int iterations) {
  // F(t,u,v) = (1-u-v) A(t) + u B(t) + v C(t); L_k bounds its change across the unit range of t, u, v.
  double L[3] = {0, 0, 0}, largest = 0;
  for (int d = 0; d < 3; ++d) {
    for (int k = 0; k < c.n; ++k) {
      L[0] = std::fmax(L[0], std::fabs(c.to[k][d] - c.from[k][d]));
      largest = std::fmax(largest, std::fmax(std::fabs(c.from[k][d]), std::fabs(c.to[k][d])));
    }
    for (int k = 1; k < 3; ++k) L[k] = std::fmax(L[k], std::fmax(std::fabs(c.from[k][d] - c.from[0][d]), std::fabs(c.to[k][d] - c.to[0][d])));
  }
  const double inflate = distance + 32 * kEps * largest;  // |1-u-v|+u+v <= 3 rounded products of rounded corners
  const double slack = L[0] > 0 ? std::fmin(tolerance / L[0], t_max - t_begin) : t_max - t_begin;  // resolution in time
  Cell stack[tuning::kCellsWaiting];
  int n = 1;
  stack[0] = {{t_begin, 0, 0}, {t_max - t_begin, 1, 1}};
  double best = INFINITY;
  for (int i = 0; n > 0; ++i) {
    const Cell cell = stack[--n];
    if (cell.lo[0] >= best - slack) continue;
    if (i >= iterations || n + 2 > tuning::kCellsWaiting) {
      best = std::fmin(best, cell.lo[0]);  // undecided: every remaining cell counts as a hit
      continue;
    }
    if (!c.edges && cell.lo[1] + cell.lo[2] > 1) continue;
    bool outside = false, tiny = true;
    for (int d = 0; d < 3 && !outside; ++d) {
      double lo = INFINITY, hi = -INFINITY;
      for (int e = 0; e < 2; ++e) {
        const double t = cell.lo[0] + e * cell.width[0];
        const double A = c.from[0][d] + t * (c.to[0][d] - c.from[0][d]);
        const double B = c.from[1][d] + t * (c.to[1][d] - c.from[1][d]);
        const double C = c.from[2][d] + t * (c.to[2][d] - c.from[2][d]);
        for (int k = 0; k < 4; ++k) {
          const double u = cell.lo[1] + (k & 1) * cell.width[1], v = cell.lo[2] + (k >> 1) * cell.width[2];
          const double f = (1 - u - v) * A + u * B + v * C;
          lo = std::fmin(lo, f), hi = std::fmax(hi, f);
        }
      }
      outside = lo > inflate || hi < -inflate;
      tiny = tiny && hi - lo <= tolerance;
    }
    if (outside) continue;
    int split = 0;
    for (int k = 1; k < 3; ++k)
      if (cell.width[k] * L[k] > cell.width[split] * L[split]) split = k;
    if (tiny || cell.width[split] <= tuning::kNarrowest) {
      best = cell.lo[0];
      continue;
    }
    const double half = cell.width[split] / 2;
    Cell late = cell, early = cell;
    late.width[split] = early.width[split] = half;
    late.lo[split] += half;
    stack[n++] = late;
    stack[n++] = early;
  }
  if (best > t_max) return kNoImpact;
  return std::fmax(best - slack, t_begin);
}

MORTISE_HD inline double first_impact(const Vec3 x0[4], const Vec3 x1[4], bool edges, double min_distance, double t_max) {
  const Corners c = corners(x0, x1, edges);
  if (!(c.size < INFINITY)) return 0;  // nothing can be certified of NaN
  double excess = INFINITY;
  const double t = advance(c, x0, x1, min_distance, t_max, 0, advance_rounding(c), tuning::kAdvances, excess);
  if (t > t_max) return kNoImpact;
  const double tolerance = tuning::kResolution * c.size;
  return inclusion(c, min_distance, t, t_max, tolerance, excess > tolerance ? tuning::kCells : tuning::kCellsInContact);
}

// Longest step t in (0, 1] that certainly keeps the share `keep` of the present distance, or kNoImpact; 0 only if the primitives
// touch or are not finite. Stops when all but a hundredth of what may be used of the distance is used.
MORTISE_HD inline double step_limit(const Vec3 x0[4], const Vec3 x1[4], bool edges, double keep) {
  const Corners c = corners(x0, x1, edges);
  const Closest near = edges ? closest_edge_edge(x0) : closest_point_triangle(x0);
  const double distance = std::sqrt(near.squared), usable = (1 - keep) * distance;
  if (!(distance > 0 && c.size < INFINITY)) return 0;
  double excess = 0;
  const double t = advance(c, x0, x1, keep * distance, 1, usable / tuning::kUsable, advance_rounding(c), tuning::kStepAdvances, excess);
  if (t > 0) return t;
  // Distances at the resolution of doubles: |q| shrinks no faster than its corners move.
  double speed = 0;
  for (int k = 0; k < c.n; ++k) speed = std::fmax(speed, (c.to[k] - c.from[k]).norm());
  return speed > usable / 2 ? usable / (2 * speed) : kNoImpact;
}

}  // namespace detail

// Conservative time of impact in [0, t_max], t_max <= 1: before it the distance of the pair certainly exceeds min_distance;
// kNoImpact (> t_max) if it does so throughout. Never misses an impact; contacts closer than about 1e-6 of the size of the pair
// may be reported although they do not happen. x0, x1: vertices at t = 0 and 1 [m].
MORTISE_HD inline double ccd_point_triangle(const Vec3 x0[4], const Vec3 x1[4], double min_distance, double t_max) {
  return detail::first_impact(x0, x1, false, min_distance, t_max);
}
MORTISE_HD inline double ccd_edge_edge(const Vec3 x0[4], const Vec3 x1[4], double min_distance, double t_max) {
  return detail::first_impact(x0, x1, true, min_distance, t_max);
}

}  // namespace mortise::geometry
