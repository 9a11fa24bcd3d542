#pragma once
// What the kernels of mortar_contact read besides positions, and the weights that need nothing else (formulas: sampling.h).
#include <cmath>

#include "effects/contact/topology.h"
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
  double d_hat = 0;       // [m]
  double taper = 0;       // width e; 0 = consistent weights
  double share = 1;       // factor of all weights: 1/2 when both sides are slaves
  Index quadrature = 3;   // points, or kExact
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
  View<const Index> slaves;          // triangles that are slaves, environments contiguous
  View<const double> support;        // their support radius d_hat_i [m]
  View<const Vec3> normal;           // of every triangle, now
  View<const double> area;           // [m^2]
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
MORTISE_HD inline double feature_weight(const Scene& s, const Vec3& n, const View<const Index>& list, Index begin, Index end, double given_back) {
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

}  // namespace mortise::effects::mortar
