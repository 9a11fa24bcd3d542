#pragma once
// Surfaces whose meshes do not match, tied by mortar conditions with a dual basis (Wohlmuth, SIAM J. Numer. Anal. 38, 2000). On the slave surface
//
//     int psi_j (x_slave - x_master) dA = 0     for every slave node j,        int psi_j N_l dA = delta_jl c_j,   c_j = int N_j dA,
//
// psi = C M^-1 N on every face, M = int N N^T dA, C = diag(c), so that a slave node follows the master nodes k beside it alone:
//
//     x_j = sum_k w_jk x_k,   w_jk = int psi_j N_k dA / c_j.
//
// Both hold what is linear: sum_j psi_j = 1 hands on an even pressure, and a linear field is the same on both sides. Quadratic faces have c = 0 at
// corners; there N~_corner = N + a (N of the middles beside it) and N~_middle = (1 - 2a) N take the place of N, a = 1/5, and the nodes follow from
// their coefficients x~ (Popp, Wohlmuth, Gee, Wall, SIAM J. Sci. Comput. 34, 2012):
//
//     x_corner = x~_corner,   x_middle = (1 - 2a) x~_middle + a (x~ of the two corners beside it).
//
// What is left at rest, d_j = X_j - sum_k w_jk X_k (gaps between the surfaces, curvature), is carried along by the master's tetrahedron there,
// F d_j with F = sum_a q_a grad lambda_a^T over its corners: linear too, and the same after any turn.
#include <vector>

#include "model/input.h"
#include "model/ties.h"

namespace mortise::effects::mortar_tie {

// A side of the tie: faces of three or six nodes of one soft body at rest.
struct Side {
  const model::BodyInput* body;
  std::vector<std::vector<Index>> faces;  // node numbers in the body, the corners first
};
// The faces of the body of which all nodes are in `nodes` (ascending).
Side side_of(const model::BodyInput& body, const std::vector<Index>& nodes);

struct Row {
  Index node;                         // of the slave's body
  std::vector<model::TieTerm> terms;  // nodes of the master's body
};
// What every slave node follows. Master faces farther than `reach` along the slave's normal are not seen. Throws Error(Exit::scene, at) where a slave
// face is not covered, or twice.
std::vector<Row> rows(const Side& slave, const Side& master, double reach, const SourceLoc& at);

}  // namespace mortise::effects::mortar_tie
