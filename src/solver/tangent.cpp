#include "solver/tangent.h"

#include <cmath>

#include "solver/kernels.h"
#include "solver/linear_whole.h"
#include "solver/tuning.h"

namespace mortise::solver {

Tangent::Tangent(System& system)
    : system_(system),
      linear_(choose_linear(system.model, system.options).kind == "cg" ? make_cg(system.model, system.rows, system.options)
                                                                       : make_direct(system.model, system.rows, false)),
      at_(system.potential.linearised()),
      beside_(system.potential.linearised()) {}

void Tangent::linearise(const device::Buffer<Vec3>& q) {
  q_.copy_from(q);
  linear_->begin_solve(true);
  const EnvMask all(1, 1), none(1, 0);
  const std::vector<double> nothing(1, 0.0);
  bool convex = false;
  // The exact Hessian; where that is no minimum's (a step of motion may end at one that inertia alone holds), a convex one serves as its factor.
  for (double concave : {1.0, 0.0}) {
    system_.potential.linearise(q.view(), effects::Want::jacobian(effects::Curvature(true, concave)), at_, true);
    system_.potential.sample(at_);
    device::Fetch fetch;
    system_.matrix(at_, q.view(), none, matrix_, fetch, fetch);
    fetch.now("tangent");
    if (linear_->prepare({matrix_, {}, {}, nothing, nothing, q.view()}, all)[0]) break;
    if (concave == 0) throw Failure{"the linearised equations of the step have no factor"};
    convex = true;
  }
  if (convex) system_.potential.linearise(q.view(), effects::Want::jacobian(effects::Curvature(true, 1)), at_, true);
  assembled_ = system_.potential.complete(at_);
  system_.right_hand_side(at_, {}, forces_);
}

void Tangent::product(device::View<const Vec3> d, bool transposed, device::Buffer<Vec3>& out) {
  if (assembled_ || transposed) {
    system_.potential.jacobian_product(at_, transposed, d, out);
    return;
  }
  const double size = largest(d, system_.model.env_blocks)[0], h = size > 0 ? tuning::kTangentDifference * system_.length[0] / size : 0;
  out.resize(d.n);
  out.zero();
  for (double sign : {1.0, -1.0}) {
    if (h == 0) break;
    moved_.copy_from(q_);
    add_scaled(d, {sign * h}, std::as_const(system_.model.block_env).view(), moved_);
    system_.potential.linearise(std::as_const(moved_).view(), {}, beside_, true);
    add_scaled(std::as_const(beside_.gradient).view(), {sign / (2 * h)}, std::as_const(system_.model.block_env).view(), out);
  }
}

void Tangent::solve(device::View<const Vec3> f, bool transposed, device::Buffer<Vec3>& x) {
  x.resize(f.n);
  x.zero();
  if (f.n == 0) return;
  const EnvMask all(1, 1);
  const linalg::Operator J = system_.on_rows([&](device::View<const Vec3> in, device::Buffer<Vec3>& out) { product(in, transposed, out); });
  const std::vector<double> f2 = dot(f, f, system_.rows.env);
  if (!std::isfinite(f2[0])) throw Failure{"a force is not finite"};
  const double wanted = assembled_ || transposed ? tuning::kTangent : tuning::kTangentByDifferences;
  const LinearSystem linear{matrix_, f, x.view(), f2, f2, q_.view(), &J};
  const linalg::Operator inverse = [&](device::View<const Vec3> in, device::View<Vec3> out) { linear_->apply(matrix_, in, out, all); };
  const linalg::GmresResult end = solve_whole(system_.model, linear, all, system_.rows.env, {wanted}, tuning::kTangentMost, linalg::awaited(inverse));
  if (!(end.relative[0] <= tuning::kTangentRough)) throw Failure{"the linearised equations of the step do not let themselves be solved"};
}

}  // namespace mortise::solver
