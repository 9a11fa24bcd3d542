#pragma once

namespace mortise::effects {

// What assemble() is to add to the gradient: nothing, or the Hessian with a share of its negative curvature. Share 0 makes every
// piece positive semi-definite, which Newton's method needs far from a solution; share 1 is the exact Hessian, without which it
// converges only linearly close to one (Longva, Loschner, Fernandez-Fernandez, Larionov, Bender, "Pitfalls of Projection", 2023).
struct Curvature {
  constexpr Curvature(bool wanted, double concave = 0) : wanted(wanted), concave(concave) {}
  bool wanted;
  double concave;
};

}  // namespace mortise::effects
