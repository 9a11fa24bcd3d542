#pragma once
// Every quadratic tetrahedron cut into eight: one at each corner, and four around the diagonal from the middle of (0,1) to that of (2,3).
#include "geometry/mesh.h"
#include "geometry/quadratic.h"

namespace mortise::geometry {

inline constexpr int kChildren = 8;
// Node of the tetrahedron at corner k of a child.
MORTISE_HD inline int child_node(int child, int k) {
  constexpr int node[kChildren][4] = {{0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3}, {4, 9, 5, 6}, {4, 9, 6, 7}, {4, 9, 7, 8}, {4, 9, 8, 5}};
  return node[child][k];
}
// Barycentrics of a node.
inline void tet_node(int node, double l[4]) {
  for (int k = 0; k < 4; ++k) l[k] = node == k ? 1 : 0;
  if (node >= 4) l[edge_begin(node - 4)] = l[edge_end(node - 4)] = 0.5;
}

// Of a quadratic mesh: its nodes come first and are corners, then new ones in the middles of edges, where the shape functions put them (curved edges stay
// curved); children lie one after the other.
TetMesh refined(const TetMesh& mesh);

}  // namespace mortise::geometry
