// Derivatives with respect to parameters, taken along with a run. A scene S' differs from S by a hair of a parameter. Where S has solved a step, at q
// with residual r(q), the solution of S' is, but for the square of the difference,
//
//   q' = q - J^-1 P (r'(q) - r(q) + J c),   c = what the supports of S' stand elsewhere by,
//
// (once more from there, since thin contacts are far from linear within a hair: their forces had an error as large as a quarter of what a hair of a
// radius makes of them, of both sides alike; and the first time from as far beside q as S' was in the step before, since friction that holds is far
// from linear within the way that it holds to) with r' of S' itself, from where it stood when the step began: what it inherits of earlier steps
// (velocities, where friction last stuck) it has from following those. So the difference of the two runs, over the difference of the parameter, is
// the derivative along the whole trajectory, of whatever is measured of them: dQ/dp = dQ/dp at fixed q - dQ/dq . J^-1 dr/dp, two linear solves per
// parameter and step with a factor that all share. The adjoint, J^T lambda = dQ/dq, gives the same from one solve per quantity; it needs dQ/dq of
// everything that may be measured, and steps backwards.
//
// Where S' is S itself but for a share of a fault that it mends - of what steps leave out, of the gap that contact leaves, of the residual that is
// left of a solution (then r(q) is not taken off) - that difference is what the fault makes of whatever is measured, to first order.
#include <cmath>

#include "solver/kernels.h"
#include "solver/simulation.h"
#include "solver/tuning.h"

namespace mortise::solver {

void Simulation::mend(effects::Fault fault, double share) {
  if (fault == effects::Fault::solution) resolved_ = share;
  for (const auto& effect : effects_) effect->mend(fault, share);
}

void Simulation::lead_on(const effects::StepInfo& info) {
  if (refitted_)
    throw Failure{
        "effects fitted something to the solution of step " + std::to_string(step_[0]) +
        " (the stiffness of a contact, which `stiffness:` may give instead; or the torque of a joint that mimics): how it would be chosen beside "
        "is no smooth matter"};
  if (!tangent_) tangent_ = std::make_unique<Tangent>(newton_.system());
  tangent_->linearise(newton_.q());
  tangent_step_ = -1;
  device::Buffer<Vec3> still;
  newton_.system().supports(newton_.q().view(), still);
  for (Simulation* other : others_) {
    if (!other->lost_[0].empty()) continue;
    try {
      other->follow(info, *this, std::as_const(still).view());
    } catch (const Failure& failure) {
      other->lost_[0] = "in step " + std::to_string(step_[0]) + ": " + failure.reason;
    }
  }
}

// still: what the leader's own supports have left, which is rounding.
void Simulation::follow(const effects::StepInfo& info, Simulation& leader, device::View<const Vec3> still) {
  for (const auto& effect : effects_) effect->begin_step(info);
  for (std::size_t k = 0; k < effects_.size(); ++k) effects_[k]->keep_pace(*leader.effects_[k], leader.newton_.q().view());
  const EnvMask all(1, 1);
  Tangent& J = *leader.tangent_;
  System& system = newton_.system();
  system.begin_solve();
  if (system.rows.of_block_host != leader.newton_.system().rows.of_block_host) throw Failure{"what is held differs: there is no derivative"};
  const device::Buffer<Vec3>& q = leader.newton_.q();

  Linearised& at = newton_.at();
  device::Buffer<Vec3> c, move, f, Jc, x, dq, from, there;
  if (apart_.size() == q.size())
    advance(q.view(), std::as_const(apart_).view(), {1.0}, model_, there);
  else
    there.copy_from(q);
  for (int round = 0; round < tuning::kFollows; ++round) {
    from.copy_from(there);
    // r'(q) - r(q) + J c, on the rows.
    system.potential.linearise(std::as_const(from).view(), {}, at, true);
    system.supports(std::as_const(from).view(), c);
    subtract(std::as_const(c).view(), still, move);
    J.product(std::as_const(move).view(), false, Jc);
    system.right_hand_side(at, std::as_const(Jc).view(), f);
    device::Buffer<Vec3> rest;
    subtract(std::as_const(f).view(), J.forces().view(), rest);
    if (resolved_ != 0) add_scaled(J.forces().view(), {resolved_}, std::as_const(model_.block_env).view(), rest);
    J.solve(std::as_const(rest).view(), false, x);
    system.to_blocks(std::as_const(x).view(), std::as_const(c).view(), all, dq);
    advance(std::as_const(from).view(), std::as_const(dq).view(), {1.0}, model_, there);
  }
  subtract(std::as_const(there).view(), q.view(), apart_);
  newton_.end_at(there);
  if (!std::isfinite(newton_.energies().total(0))) throw Failure{"a hair of the parameter makes surfaces meet or elements turn over"};
  accept(info, leader.lost_energy(info));
}

}  // namespace mortise::solver
