#pragma once
// Consistent weights: the exact overlap as it is. Over a covered slave triangle sum w N_a and sum w M_b are exact, which is what the patch
// test asks for. Edges and points are there for what faces cannot see, a ridge or a tip: their w is a third of the area of the adjacent
// triangles T times
//     H(min_T (1 + n . n_T) / (1 - cos 10 deg))           none where a face is parallel to the slave
//   x H(max_T (1 - c . n_T) / (1 - cos 30 deg))           none where the master is flat, next to none on the facets of a curved
//                                                         surface; c = mean normal
//   x H(-n . c / 0.2)                                     none on the far side,
// H(s) = 3 s^2 - 2 s^3 from 0 to 1. They belong to all slave triangles nearby, so that forces are continuous. Faces at an angle to the
// slave fade out between 49 and 70 degrees: what such faces hold between them are edges and tips.
#include <cmath>

#include "effects/mortar_contact/layers.h"

namespace mortise::effects::mortar {

// How far slave triangle t is bent against its neighbour over side k: 0 where they lie in one plane, 1 from 1 degree on.
MORTISE_HD inline double bend(const MortarView& s, Index t, int k, const Vec3& n) {
  const Ring ring = over_side(s, t, k);
  double largest = 0;
  for (Index j = ring.begin; j < ring.end; ++j) largest = std::fmax(largest, 1 - n.dot(s.normal[ring.list[j]]));
  return hermite(largest / tuning::kBent);
}

// Half the width [m] of the strip along side k in which triangle and neighbour share what lies at a gap above.
template <class T>
MORTISE_HD inline T strip(const SlaveOf<T>& p, int k, const T& gap) {
  return larger(p.bend[k] * gap, tuning::kStrip * p.altitude(k));
}

// How much a point above w belongs to the triangle: 1 inside, 0 outside, and in between in the strips along its sides. Where the slave is
// bent they are as wide as the gap, so that the force on an edge or a tip that slides from one triangle to the next turns with it
// rather than jumping from one normal to the other. Over a common side the shares of both triangles add up to 1. The last factor
// ends what the product of strips goes beyond a sharp corner.
template <class T>
MORTISE_HD inline T belongs(const SlaveOf<T>& p, const T w[3], const T& gap) {
  if (!(gap > 0)) return 0;
  T part = 1;
  MORTISE_ROLLED for (int k = 0; k < 3; ++k) part *= hermite<T>(0.5 + w[k] * p.altitude(k) / (2 * strip(p, k, gap)));
  return part > 0 ? part * hermite<T>(2 + 2 * rim_distance<T>(p.y, w) / gap) : T(0);
}

struct Consistent {
  static constexpr bool kWhole = true;  // overlaps may be integrated from their moments

  MORTISE_HD explicit Consistent(const Settings&) {}

  // Of faces with -n . n_master.
  template <class T>
  MORTISE_HD T facing(const T& cosine) const {
    return hermite<T>((cosine - tuning::kFaceNone) / tuning::kFaceFade);
  }

  // Factors of samples at barycentrics M of the master triangle, at t along its edge.
  template <class T>
  MORTISE_HD T on_face(const T[3]) const {
    return 1;
  }
  template <class T>
  MORTISE_HD T on_edge(const T&) const {
    return 1;
  }

  // The edge from P to Q over the triangle and its outer strips, cut where it enters and leaves what is within all inner ones.
  template <class T>
  MORTISE_HD bool stretches(const SlaveOf<T>& p, const T P[3], const T Q[3], const T& gap, Stretches<T>& out) const {
    T grow[3], shrink[3];
    for (int k = 0; k < 3; ++k) grow[k] = strip(p, k, gap) / p.altitude(k), shrink[k] = -grow[k];
    T in, back;
    clip_segment(P, Q, grow, out.t[0], out.t[3]);
    if (!(out.t[0] < out.t[3])) return false;
    clip_segment(P, Q, shrink, in, back);
    if (in > back) in = back = 0.5 * (in + larger(back, T(0.0)));  // nothing is inside: one cut, where the inside would appear
    out.t[1] = smaller(larger(in, out.t[0]), out.t[3]);
    out.t[2] = smaller(larger(back, out.t[0]), out.t[3]);
    return true;
  }
  // How much of the edge, of a point on it at a gap, of a vertex belongs to the triangle.
  template <class T>
  MORTISE_HD double share_of_edge(const MortarView&, const SlaveOf<T>&, const Vec3&, const T[3], const T[3], const Stretches<T>&) const {
    return 1;
  }
  template <class T>
  MORTISE_HD T share_on_edge(const SlaveOf<T>& p, const T N[3], const T& gap) const {
    return belongs(p, N, gap);
  }
  template <class T>
  MORTISE_HD T share_of_point(const MortarView&, const SlaveOf<T>& p, const Vec3&, const T N[3], const T& gap) const {
    return belongs(p, N, gap);
  }

  // Weight [m^2] of a master edge or vertex whose triangles are list[begin..end).
  MORTISE_HD double edge_weight(const MortarView& s, const Vec3& n, const View<const Index>& list, Index begin, Index end) const {
    return feature_area(s, n, list, begin, end);
  }
  MORTISE_HD double point_weight(const MortarView& s, const Vec3& n, const View<const Index>& list, Index begin, Index end) const {
    return feature_area(s, n, list, begin, end);
  }

  // The area [m^2] that stands behind them.
  MORTISE_HD static double feature_area(const MortarView& s, const Vec3& n, const View<const Index>& list, Index begin, Index end) {
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
    return sum / 3 * hermite(parallel / tuning::kGate) * hermite(sharp / tuning::kSharp) * hermite(-n.dot(mean) / tuning::kFarSide);
  }
  // Adds x times its derivative: to(triangle, c, a) adds c . dn + a dA of a triangle.
  template <class To>
  MORTISE_HD static void area_slopes(const MortarView& s, Index slave, const Vec3& n, const View<const Index>& list, Index begin, Index end, double x,
                                     const To& to) {
    Vec3 sum_n = Vec3::Zero();
    double sum = 0, parallel = 2, sharp = 0;
    Index most_parallel = -1, sharpest = -1;
    for (Index k = begin; k < end; ++k) {
      const Vec3 nm = s.normal[list[k]];
      sum_n += nm, sum += s.area[list[k]];
      if (1 + n.dot(nm) < parallel) parallel = 1 + n.dot(nm), most_parallel = k;
    }
    const Vec3 mean = sum_n / sum_n.norm();
    for (Index k = begin; k < end; ++k)
      if (1 - mean.dot(s.normal[list[k]]) > sharp) sharp = 1 - mean.dot(s.normal[list[k]]), sharpest = k;
    const double far = -n.dot(mean) / tuning::kFarSide, A = hermite(parallel / tuning::kGate), B = hermite(sharp / tuning::kSharp), C = hermite(far);
    const double by_parallel = x * sum / 3 * hermite_slope(parallel / tuning::kGate) / tuning::kGate * B * C;
    const double by_sharp = x * sum / 3 * A * hermite_slope(sharp / tuning::kSharp) / tuning::kSharp * C;
    const double by_far = x * sum / 3 * A * B * hermite_slope(far) / tuning::kFarSide;
    Vec3 by_n = -by_far * mean, by_mean = -by_far * n;
    if (most_parallel >= 0) by_n += by_parallel * s.normal[list[most_parallel]];
    if (sharpest >= 0) by_mean -= by_sharp * s.normal[list[sharpest]];
    by_mean = Vec3((by_mean - mean.dot(by_mean) * mean) / sum_n.norm());
    to(slave, by_n, 0.0);
    for (Index k = begin; k < end; ++k) {
      Vec3 c = by_mean;
      if (k == most_parallel) c += by_parallel * n;
      if (k == sharpest) c -= by_sharp * mean;
      to(list[k], c, x / 3 * A * B * C);
    }
  }
};

}  // namespace mortise::effects::mortar
