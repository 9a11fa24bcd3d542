// What goes beside a simulation S, to first order. A companion S' differs from S by a hair: of a parameter, or because it does a share of what S
// leaves undone. Where S has solved a step, at q with residual r(q), the solution of S' is, but for the square of the difference,
//
//   q' = q - J^-1 P (r'(q) - (1 - e) r(q) + J c') + c',   c' = c - (1 - e) c_S,
//
// with r' of S' itself, from where it stood when the step began: what it inherits of earlier steps (velocities, where friction last stuck) it has
// from following those, c and c_S what supports of S' and of S stand elsewhere by, and e the share of what S has left that S' takes away. So the
// difference of the two runs, over the difference of the parameter, is the derivative along the whole trajectory, of whatever is measured of them:
// one linear solve per companion and step with a factor that all share. (The adjoint would take one per quantity, the gradient of everything that may
// be measured, and steps backwards.)
//
// A shadow is S on richer meshes: it stands where the displacements of S put it, and does not solve. What its own equations have left there, r(q), is
// what the meshes of S left undone: a companion of the shadow that takes a share e away tells what becomes of all numbers, over e. It is the estimate
// of dual-weighted residuals without duals, for all quantities at once.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/cpu_time.h"
#include "solver/kernels.h"
#include "solver/simulation.h"

namespace mortise::solver {

void Simulation::each_beside(const std::function<void(Simulation&)>& work) const {
  for (const Companion& c : others_) work(*c.of);
  for (const Shadow& s : shadows_) work(*s.of), s.of->each_beside(work);
}

// One that cannot go on is lost, with the reason; nothing else happens to the leader.
void Simulation::try_beside(Simulation& other, const std::function<void()>& work) const {
  if (!other.lost_[0].empty()) return;
  try {
    work();
  } catch (const Failure& failure) {
    other.lost_[0] = "in step " + std::to_string(step_[0]) + ": " + failure.reason;
  }
}

// Begins where the leader stands, at q.
void Simulation::join(const device::Buffer<Vec3>& q, const Simulation& leader) {
  if (leader.step_[0] > 0) model_.q.copy_from(q);
  step_ = leader.step_, time_ = leader.time_;
}

void Simulation::lead(std::vector<Companion> others) {
  others_ = std::move(others);
  for (const Companion& c : others_) {
    c.of->join(model_.q, *this);
    if (c.by.integrator > 0)
      for (const auto& effect : c.of->effects_) effect->raise_order(c.by.integrator);
  }
  const bool estimates = std::all_of(others_.begin(), others_.end(), [](const Companion& c) { return c.by.fits; });
  tangent_ = others_.empty() ? nullptr : std::make_unique<Tangent>(newton_.system(), estimates ? Tangent::Use::estimates : Tangent::Use::derivatives);
}

void Simulation::cast(Simulation& shadow) {
  shadows_.push_back({&shadow, Lift(model_, shadow.model_)});
  device::Buffer<Vec3> q;
  shadows_.back().lift.apply(std::as_const(model_.q).view(), q);
  shadow.join(q, *this);
}

void Simulation::lead_on(const effects::StepInfo& info) {
  if (others_.empty() && shadows_.empty()) return;
  const double begin = cpu_time();
  const auto start = std::chrono::steady_clock::now();
  const auto all_lost = [&](const std::string& why) {
    for (const Companion& c : others_) try_beside(*c.of, [&] { throw Failure{why}; });
  };
  try {
    if (!others_.empty()) tangent_->linearise(newton_.q());
    device::Buffer<Vec3> still;
    newton_.system().supports(newton_.q().view(), still);
    for (const Companion& c : others_) try_beside(*c.of, [&] { c.of->follow(info, *this, c.by, std::as_const(still).view()); });
  } catch (const Failure& failure) {
    all_lost(failure.reason);
  }
  for (const Shadow& s : shadows_) try_beside(*s.of, [&] { s.of->take(info, *this, s.lift); });
  beside_time_.cpu += cpu_time() - begin;
  beside_time_.wall += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void Simulation::begin_beside(const effects::StepInfo& info, const Simulation& leader, bool fits) {
  if (leader.refitted_ && !fits)
    throw Failure{
        "effects fitted something to the solution (a stiffness that is auto, the torque of a joint that mimics): how it would be chosen beside is no "
        "smooth matter; give stiffnesses as numbers"};
  for (const auto& effect : effects_) effect->begin_step(info);
  for (std::size_t k = 0; k < effects_.size() && fits; ++k)
    if (!effects_[k]->take_after(*leader.effects_[k]))
      throw Failure{"what '" + std::string(effects_[k]->name()) + "' fits to the solution cannot be taken over"};
  newton_.system().begin_solve();
}

// still: what the leader's own supports have left, which is rounding where it has solved its equations.
void Simulation::follow(const effects::StepInfo& info, Simulation& leader, const Departure& by, device::View<const Vec3> still) {
  begin_beside(info, leader, by.fits);
  const EnvMask all(1, 1);
  Tangent& J = *leader.tangent_;
  System& system = newton_.system();
  if (system.rows.of_block_host != leader.newton_.system().rows.of_block_host) throw Failure{"what is held differs: there is no derivative"};
  const device::Buffer<Vec3>& q = leader.newton_.q();
  const device::View<const Index> env = std::as_const(model_.block_env).view();  // one environment: of rows as well

  // r'(q) - (1 - e) r(q) + J c', on the rows.
  Linearised& at = newton_.at();
  system.potential.linearise(q.view(), {}, at, true);
  device::Buffer<Vec3> c, move, f, Jc, x, dq, there;
  system.supports(q.view(), c);
  move.copy_from(c);
  add_scaled(still, {by.residual - 1}, env, move);
  J.product(std::as_const(move).view(), false, Jc);
  system.right_hand_side(at, std::as_const(Jc).view(), f);
  add_scaled(J.forces().view(), {by.residual - 1}, env, f);
  J.solve(std::as_const(f).view(), false, x);

  system.to_blocks(std::as_const(x).view(), std::as_const(move).view(), all, dq);
  if (by.residual > 0) {
    there.copy_from(q);
    add(std::as_const(dq).view(), there);
  } else {
    advance(q.view(), std::as_const(dq).view(), {1.0}, model_, there);
  }
  newton_.end_at(there);
  if (!std::isfinite(newton_.energies().total(0))) throw Failure{"a hair of the parameter makes surfaces meet or elements turn over"};
  accept(info, leader.lost_energy(info));
}

// Where the leader's displacements put this one.
void Simulation::take(const effects::StepInfo& info, Simulation& leader, const Lift& lift) {
  begin_beside(info, leader, true);
  device::Buffer<Vec3> there;
  lift.apply(leader.newton_.q().view(), there);
  newton_.end_at(there);
  if (!std::isfinite(newton_.energies().total(0))) throw Failure{"on richer meshes surfaces meet or elements turn over"};
  refitted_ = false;
  if (tangent_ && leader.tangent_ && leader.tangent_->has_factor())
    tangent_->lean_on(std::make_unique<Coarse>(leader.newton_.system(), *leader.tangent_, newton_.system(), lift));
  lead_on(info);
  accept(info, leader.lost_energy(info));
}

}  // namespace mortise::solver
