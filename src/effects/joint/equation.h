#pragma once
// An equation between coordinates of joints that is not linear in blocks, so that no tie can say it:
//
//     c = x - r y - b = 0        x, y: coordinates (model/coordinate.h); only x where there is no y
//
// a hinge that turns r times as far as another, a rack and its pinion; or the way of a body across its slide, where the carrier moves freely. It is
// held by an augmented Lagrangian,
//
//     E = lambda c + K c^2 / 2,        gradient (lambda + K c) (grad x - r grad y),
//
// whose minimum Newton's method finds; then lambda becomes lambda + K c, until |c| is nothing. -(lambda + K c) is the torque on x [N m, N].
#include "model/coordinate.h"

namespace mortise::effects::joint {

struct Equation {
  model::Coordinate x, y;
  bool two = false;  // there is y
  double ratio = 0, offset = 0;
  double lambda = 0, K = 0;  // [N m, N], [N m/rad, N/m]
};
inline constexpr int kEquationBlocks = 2 * model::kCoordinateBlocks;  // of x and of y; a block that both have stands there twice

struct EquationReading {
  model::HingeDirections x, y;
};
MORTISE_HD inline EquationReading reading(const Equation& e, device::View<const Vec3> q, bool change = false) {
  EquationReading r{model::reading(e.x, q, change), {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}};
  if (e.two) r.y = model::reading(e.y, q, change);
  return r;
}

MORTISE_HD inline double miss(const Equation& e, const EquationReading& r) {
  return model::coordinate(e.x, r.x) - (e.two ? e.ratio * model::coordinate(e.y, r.y) : 0.0) - e.offset;
}
MORTISE_HD inline double energy(const Equation& e, const EquationReading& r) {
  const double c = miss(e, r);
  return (e.lambda + 0.5 * e.K * c) * c;
}

// Gradient and Hessian of E, as coordinate_stencil, over the blocks of x and y.
MORTISE_HD inline void equation_stencil(const Equation& e, const EquationReading& r, double concave, Index* block, Vec3* grad, Mat3* hess) {
  constexpr int kOne = model::kCoordinateBlocks;
  const double force = e.lambda + e.K * miss(e, r);
  Vec3 g[kEquationBlocks];
  model::coordinate_stencil(e.x, r.x, 1, 0, 0, block, g, nullptr);
  if (e.two) {
    model::coordinate_stencil(e.y, r.y, -e.ratio, 0, 0, block + kOne, g + kOne, nullptr);
  } else {
    for (int b = kOne; b < kEquationBlocks; ++b) block[b] = -1, g[b] = Vec3::Zero();
  }
  for (int b = 0; b < kEquationBlocks; ++b) grad[b] = force * g[b];
  if (!hess) return;
  for (int a = 0; a < kEquationBlocks; ++a)
    for (int b = a; b < kEquationBlocks; ++b) hess[linalg::pair_place(a, b, kEquationBlocks)] = e.K * g[a] * g[b].transpose();
  for (int part = 0; part < (e.two ? 2 : 1); ++part) {
    Index own_block[kOne];
    Vec3 own_grad[kOne];
    Mat3 own[kOne * (kOne + 1) / 2];
    model::coordinate_stencil(part == 0 ? e.x : e.y, part == 0 ? r.x : r.y, part == 0 ? force : -e.ratio * force, 0, concave, own_block, own_grad,
                              own);
    for (int a = 0; a < kOne; ++a)
      for (int b = a; b < kOne; ++b)
        hess[linalg::pair_place(kOne * part + a, kOne * part + b, kEquationBlocks)] += own[linalg::pair_place(a, b, kOne)];
  }
}

// How far one may go along a change of both before turns can no longer be counted.
MORTISE_HD inline double equation_way(const Equation& e, const EquationReading& r, const EquationReading& change) {
  double alpha = model::coordinate_way(e.x, r.x, change.x, model::coordinate(e.x, r.x), INFINITY, INFINITY);
  if (!e.two) return alpha;
  const double of_y = model::coordinate_way(e.y, r.y, change.y, model::coordinate(e.y, r.y), INFINITY, INFINITY);
  return of_y < alpha ? of_y : alpha;
}

}  // namespace mortise::effects::joint
