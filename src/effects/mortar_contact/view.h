#pragma once
// What the kernels of mortar_contact read besides positions.
#include <cmath>

#include "base/jet.h"
#include "effects/contact/topology.h"
#include "effects/mortar_contact/tuning.h"
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
  double taper = 0;        // width e; 0 = consistent weights
  double pass_weight = 1;  // factor of all weights: 1/2 when both sides are slaves
  Index quadrature = 3;    // points, or kExact
  bool exact = false;      // three-term gap gradient
  bool averaged = false;   // one gap per slave node (averaged.h)
  MORTISE_HD bool tapered() const { return taper > 0; }
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
struct MortarView {
  Settings set;
  geometry::SurfaceView surface;  // pair_allowed: slave, master
  contact::TopologyView topology;
  View<const Index> interface;  // per pair of slave and master body or half-space: interface, or -1
  View<const double> kappa;     // per interface [Pa]
  View<const double> d_hat;     // per interface [m]
  View<const contact::Plane> planes;
  View<const Index> slaves;          // triangles that are slaves, environments contiguous
  View<const double> support;        // their support radius d_hat_i [m]
  View<const Vec3> normal;           // of every triangle, now
  View<const double> area;           // [m^2]
  View<const geometry::Face> faces;  // quadratic ones
  View<const Index> quarter;         // per triangle: 4 face + quarter, or -1; empty where all faces are linear
  View<const double> bow;            // and the most by which the face stands off the triangle [m]
  MORTISE_HD double bow_of(Index triangle) const { return bow.n > 0 ? bow[triangle] : 0; }
  MORTISE_HD bool bent(Index triangle) const { return quarter.n > 0 && quarter[triangle] >= 0; }
  MORTISE_HD FaceNodes nodes_of(Index triangle) const {
    const Index q = quarter.n > 0 ? quarter[triangle] : -1;
    FaceNodes out;
    out.count = q < 0 ? 3 : 6;
    out.quarter = q < 0 ? -1 : static_cast<int>(q % 4);
    for (int k = 0; k < out.count; ++k) out.point[k] = q < 0 ? surface.triangles[triangle].v[k] : faces[q / 4].v[k];
    return out;
  }
  MORTISE_HD Index interface_at(Index slave_body, Index master) const { return interface[surface.pairs.of(slave_body, master)]; }
};

// C1 step.
template <class T>
MORTISE_HD inline T hermite(const T& s) {
  return s <= 0 ? T(0) : s >= 1 ? T(1) : s * s * (3 - 2 * s);
}

MORTISE_HD inline double hermite_slope(double s) { return s <= 0 || s >= 1 ? 0 : 6 * s * (1 - s); }

}  // namespace mortise::effects::mortar
