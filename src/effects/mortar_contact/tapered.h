#pragma once
// Tapered weights, the published form: faces x H(min_b M_b / e), edges x H(min(t, 1-t) / e), and edge and point weights that give back
// what the faces lose, e sum_T A_T and 0.1 e^2 sum_T A_T over the facing triangles T (README). Edges and points belong to the slave triangle
// below, or in equal parts to all that have them on their rim. Faces at an angle to the slave fade out between 81 and 87 degrees.
#include <cmath>

#include "effects/mortar_contact/layers.h"

namespace mortise::effects::mortar {

// Does slave triangle t go on in the direction of n (rather than round a rim)?
MORTISE_HD inline bool goes_on(const MortarView& s, const Vec3& n, Index t) { return n.dot(s.normal[t]) > tuning::kGoesOn; }

// One over the number of slave triangles that find what lies on side k of `slave`.
MORTISE_HD inline double side_multiplicity(const MortarView& s, Index slave, const Vec3& n, int k) {
  const Ring ring = over_side(s, slave, k);
  Index count = 0;
  for (Index j = ring.begin; j < ring.end; ++j)
    if (goes_on(s, n, ring.list[j])) ++count;
  return count > 1 ? 1.0 / count : 1;
}

// The same for a master vertex above N.
template <class T>
MORTISE_HD inline double multiplicity(const MortarView& s, Index slave, const Vec3& n, const T N[3]) {
  int on = 0, side = 0, corner = 0;
  for (int k = 0; k < 3; ++k) {
    if (N[k] <= tuning::kOnSide)
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

struct Tapered {
  static constexpr bool kWhole = false;  // the taper's bends would be lost in moments

  double e;
  MORTISE_HD explicit Tapered(const Settings& set) : e(set.taper) {}

  template <class T>
  MORTISE_HD T facing(const T& cosine) const {
    return hermite<T>((cosine - tuning::kTaperedNone) / tuning::kTaperedFade);
  }

  template <class T>
  MORTISE_HD T on_face(const T M[3]) const {
    return hermite<T>(smaller(M[0], smaller(M[1], M[2])) / e);
  }
  template <class T>
  MORTISE_HD T on_edge(const T& t) const {
    return hermite<T>(smaller(t, T(1 - t)) / e);
  }

  // The part of the edge over the triangle itself.
  template <class T>
  MORTISE_HD bool stretches(const SlaveOf<T>&, const T P[3], const T Q[3], const T&, Stretches<T>& out) const {
    const T rim[3] = {tuning::kOnSide, tuning::kOnSide, tuning::kOnSide};
    clip_segment(P, Q, rim, out.t[0], out.t[3]);
    out.t[1] = out.t[0], out.t[2] = out.t[3];
    return out.t[0] < out.t[3];
  }
  template <class T>
  MORTISE_HD double share_of_edge(const MortarView& s, const SlaveOf<T>& p, const Vec3& n, const T P[3], const T Q[3],
                                  const Stretches<T>& part) const {
    double out = 1;
    for (int a = 0; a < 3; ++a)
      if (larger(P[a] + part.t[0] * (Q[a] - P[a]), P[a] + part.t[3] * (Q[a] - P[a])) <= tuning::kOnSide) out *= side_multiplicity(s, p.slave, n, a);
    return out;
  }
  template <class T>
  MORTISE_HD T share_on_edge(const SlaveOf<T>&, const T[3], const T&) const {
    return 1;
  }
  template <class T>
  MORTISE_HD T share_of_point(const MortarView& s, const SlaveOf<T>& p, const Vec3& n, const T N[3], const T&) const {
    const bool above = N[0] >= -tuning::kOnSide && N[1] >= -tuning::kOnSide && N[2] >= -tuning::kOnSide;
    return above ? multiplicity(s, p.slave, n, N) : 0;
  }

  MORTISE_HD double edge_weight(const MortarView& s, const Vec3& n, const View<const Index>& list, Index begin, Index end) const {
    return e * feature_area(s, n, list, begin, end);
  }
  MORTISE_HD double point_weight(const MortarView& s, const Vec3& n, const View<const Index>& list, Index begin, Index end) const {
    return tuning::kPointShare * e * e * feature_area(s, n, list, begin, end);
  }

  // The area [m^2] that stands behind them: what faces the slave.
  MORTISE_HD double feature_area(const MortarView& s, const Vec3& n, const View<const Index>& list, Index begin, Index end) const {
    double sum = 0;
    for (Index k = begin; k < end; ++k) sum += facing(-n.dot(s.normal[list[k]])) * -n.dot(s.normal[list[k]]) * s.area[list[k]];
    return sum;
  }

 public:
  // Adds d(weight) of an edge or vertex with x times the area that faces the slave: to(triangle, c, a) adds c . dn + a dA of a triangle.
  template <class To>
  MORTISE_HD void area_slopes(const MortarView& s, Index slave, const Vec3& n, const View<const Index>& list, Index begin, Index end, double x,
                              const To& to) const {
    for (Index k = begin; k < end; ++k) {
      const Vec3 nm = s.normal[list[k]];
      const double c = -n.dot(nm), A = s.area[list[k]], f = facing(c);
      const double by_c = x * A * (f + c * hermite_slope((c - tuning::kTaperedNone) / tuning::kTaperedFade) / tuning::kTaperedFade);
      to(slave, -by_c * nm, 0.0);
      to(list[k], -by_c * n, x * f * c);
    }
  }
};

}  // namespace mortise::effects::mortar
