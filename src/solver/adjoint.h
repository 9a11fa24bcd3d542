#pragma once
// Of a number Q that is measured of an accepted state: what it would change by if forces were a little different. With g = grad Phi, E the way of
// supports along which Q is a force of supports (Q = E . (I - P) g), and dQ/dq,
//
//   z = T (I - P) E - P lambda,   P J^T P lambda = P (dQ/dq + J^T T (I - P) E),   T: what is tied to a body goes with it
//
// a small change dg of what acts on blocks changes Q by z . dg. What the solution leaves undone is such a change:
//
//   residual   z . P g          all that Newton's method, its linear systems and lagged quantities left
//   layer      surfaces press although a gap is open between them. Moved together by their gaps g_s they would press with p(2 g_s) at the same q,
//              that is, less by k_s g_s, k_s = -d force / d gap:   z . dg = sum over samples k_s g_s d(gap_s) / dy . z
//   mesh       elements are stiffer than what they are made of, by what Fault::mesh mends (effects/elasticity/missed.h), and softer where means of
//              volumes stand for them, which is part of what Fault::volumes does
#include <vector>

#include "base/types.h"

namespace mortise::solver {

struct Functional {
  std::vector<double> points;  // dQ/dy, three per point of the model [Q/m]; empty: none
  int body = -1, axis = 0;     // or the force of supports on that body along an axis [N]
};

struct Adjoint {
  std::vector<double> points;  // z at points, three each [Q/N]
  double residual = 0;         // what is to be added to Q
  double layer = 0;
  double mesh = 0, volumes = 0;  // and what of that is changes of volume
  bool exact = true;             // J^T lacks nothing; else that samples of contact slide and turn
};

}  // namespace mortise::solver
