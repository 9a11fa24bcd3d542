// Backward Euler loses energy where potentials are convex between the ends of a step. Where they are not (a body slips past an edge within one
// step, a contact opens on another side than it closed) a step can gain some, from nowhere. With M (v1 - v0)/dt = -grad Phi(q1) + supports,
// v1 = (q1 - q0)/dt, what a step gains over the work of supports and loads is exactly
//
//   gain = sum over stores [ Phi(q1) - Phi(q0) - grad Phi(q1) . (q1 - q0) ]  -  1/2 |v1 - v0|_M^2,
//
// and the last term is the energy of inertia at q1, as 1/2 |v0|_M^2 is that at q0. Supports did the work of what they bear at q1 on their way.
#include "solver/kernels.h"
#include "solver/newton.h"

namespace mortise::solver {

void Newton::measure_gain(const Energies& at_end, device::Fetch& fetch) {
  gain_ = gain_scale_ = support_work_ = 0;
  if (!measures_energy() || start_.empty()) return fetch.now();
  device::Buffer<Vec3> move;
  subtract(q_.view(), model_.q.view(), move);
  std::vector<std::vector<double>> along(effects_.size(), {0.0});
  std::vector<double> work{0.0};
  device::Buffer<Vec3> held;
  support_move(model_.q.view(), q_.view(), model_.projector.view(), held);
  for (std::size_t k = 0; k < effects_.size(); ++k)
    if (effects_[k]->stores_energy()) dot(effect_gradients_[k].view(), move.view(), model_.env_blocks, {along[k], fetch});
  dot(gradient_.view(), held.view(), model_.env_blocks, {work, fetch});
  fetch.now();
  support_work_ = work[0];
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    const double before = start_[k][0], after = at_end[k][0];
    if (effects_[k]->stores_energy()) {
      gain_ += after - before - along[k][0];
      gain_scale_ += std::max(std::abs(before), std::abs(after));
    } else if (effects_[k]->name() == "inertia") {
      gain_ -= after;
      gain_scale_ += before;
    }
  }
}

}  // namespace mortise::solver
