#pragma once
// Shape functions of quadratic elements and the rules that integrate them. Nodes are numbered as VTK does: the corners first, then
// the middle of edge after edge,
//     triangle     (0,1) (1,2) (2,0)                          -> nodes 3, 4, 5
//     tetrahedron  (0,1) (1,2) (2,0) (0,3) (1,3) (2,3)        -> nodes 4 ... 9
// With barycentrics l of the corners, N = l (2 l - 1) at a corner and N = 4 l_a l_b in the middle of an edge (Zienkiewicz, Taylor,
// *The Finite Element Method*, vol. 1, ch. 8).
//
// A quadratic triangle is also seen as four plane ones, its *quarters*: (0 3 5), (1 4 3), (2 5 4), (3 4 5).
#include "base/types.h"

namespace mortise::geometry {

// Corners of edge e; the edges of a triangle are the first three of a tetrahedron.
MORTISE_HD inline int edge_begin(int e) { return e % 3; }
MORTISE_HD inline int edge_end(int e) { return e < 3 ? (e + 1) % 3 : 3; }

MORTISE_HD inline void triangle_shape(const double l[3], double N[6]) {
  for (int k = 0; k < 3; ++k) N[k] = l[k] * (2 * l[k] - 1);
  for (int e = 0; e < 3; ++e) N[3 + e] = 4 * l[edge_begin(e)] * l[edge_end(e)];
}

// dN/d(l1, l2), with l0 = 1 - l1 - l2.
MORTISE_HD inline void triangle_slope(const double l[3], double d1[6], double d2[6]) {
  double d[3][2] = {{-1, -1}, {1, 0}, {0, 1}};
  for (int k = 0; k < 3; ++k) d1[k] = (4 * l[k] - 1) * d[k][0], d2[k] = (4 * l[k] - 1) * d[k][1];
  for (int e = 0; e < 3; ++e) {
    const int a = edge_begin(e), b = edge_end(e);
    d1[3 + e] = 4 * (l[b] * d[a][0] + l[a] * d[b][0]);
    d2[3 + e] = 4 * (l[b] * d[a][1] + l[a] * d[b][1]);
  }
}

// Node of the triangle at corner k of a quarter.
MORTISE_HD inline int quarter_node(int quarter, int k) {
  if (quarter == 3) return 3 + k;
  return k == 0 ? quarter : k == 1 ? 3 + quarter : 3 + (quarter + 2) % 3;
}
// Barycentrics on the triangle of the point with barycentrics n on a quarter.
MORTISE_HD inline void quarter_place(int quarter, const double n[3], double l[3]) {
  if (quarter == 3) {
    for (int k = 0; k < 3; ++k) l[k] = 0.5 * (n[k] + n[(k + 2) % 3]);
    return;
  }
  l[quarter] = n[0] + 0.5 * (n[1] + n[2]);
  l[(quarter + 1) % 3] = 0.5 * n[1];
  l[(quarter + 2) % 3] = 0.5 * n[2];
}

MORTISE_HD inline double tet_shape_function(int node, const double l[4]) {
  return node < 4 ? l[node] * (2 * l[node] - 1) : 4 * l[edge_begin(node - 4)] * l[edge_end(node - 4)];
}
// dN/d(l1, l2, l3), with l0 = 1 - l1 - l2 - l3.
MORTISE_HD inline Vec3 tet_slope(int node, const double l[4]) {
  Vec3 d = Vec3::Zero();
  const auto add = [&d](int corner, double factor) {
    if (corner > 0)
      d[corner - 1] += factor;
    else
      d -= Vec3(factor, factor, factor);
  };
  if (node < 4) {
    add(node, 4 * l[node] - 1);
  } else {
    const int a = edge_begin(node - 4), b = edge_end(node - 4);
    add(a, 4 * l[b]);
    add(b, 4 * l[a]);
  }
  return d;
}

// Rule with 4 points for tetrahedra, exact to degree 2, each with a quarter of the volume: the stiffness of a tetrahedron with
// straight edges is integrated exactly.
inline constexpr int kTetPoints = 4;
MORTISE_HD inline void tet_point(int point, double l[4]) {
  for (int k = 0; k < 4; ++k) l[k] = k == point ? 0.58541019662496845446 : 0.13819660112501051518;
}

}  // namespace mortise::geometry
