#pragma once
#include "device/device.h"

namespace mortise::effects {

// Which matrix linearise() is to find: none, or the Hessian with a share of its negative curvature. Share 0 makes every piece positive
// semi-definite, which Newton's method needs far from a solution; share 1 is the exact Hessian, without which it converges only linearly
// close to one (Longva, Loschner, Fernandez-Fernandez, Larionov, Bender, "Pitfalls of Projection", 2023).
struct Curvature {
  constexpr Curvature(bool wanted, double concave = 0) : wanted(wanted), concave(concave) {}
  explicit Curvature(device::View<const double> of_env) : wanted(true), of_env(of_env) {}
  bool wanted;
  double concave = 0;                   // share in all environments,
  device::View<const double> of_env{};  // or in each of them
  MORTISE_HD double concavity(Index env) const { return of_env.n > 0 ? of_env[env] : concave; }
};

// In which environments linearise() is to find what samples do that move: derivatives of what it freezes.
struct Moving {
  constexpr Moving(bool wanted) : wanted(wanted) {}
  explicit Moving(device::View<const std::uint8_t> of_env) : wanted(true), of_env(of_env) {}
  bool wanted;
  device::View<const std::uint8_t> of_env{};  // or, where it is empty, in all
  MORTISE_HD bool in(Index env) const { return wanted && (of_env.n == 0 || of_env[env]); }
};

// How much linearise() is to find: what it freezes, always; forces; the matrix; and, where that is not the whole Jacobian, the rest of it: what hangs
// on lagged quantities, and what samples do that move.
struct Want {
  bool forces = true;
  Curvature matrix = false;
  bool whole = false;
  Moving moving = false;
  bool foreseen = false;  // at the state that Effect::foresee() was last asked for
  bool here = false;      // or where the linearisation was filled last, at least with what it freezes
  static Want frozen() { return {false, false}; }
  static Want jacobian(Curvature matrix) { return {true, matrix, true, true}; }
};

}  // namespace mortise::effects
