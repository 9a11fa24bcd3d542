#include "solver/outlook.h"

#include <cmath>
#include <utility>

#include "solver/kernels.h"
#include "solver/tuning.h"

namespace mortise::solver {

Outlook::Outlook(System& system, Linear& linear, EnergyLedger& energies, SaddlePolicy& saddle)
    : system_(system),
      options_(system.options),
      linear_(linear),
      energies_(energies),
      saddle_(saddle),
      creep_(system.model.envs),
      progress_(system.model.envs) {}

void Outlook::begin() { nearest_force_.assign(system_.model.envs, INFINITY); }

void Outlook::look(const Residual& r, Index iteration, const std::function<double(Index)>& wanted, EnvTable& envs, device::Buffer<Vec3>& q) {
  const Potential& potential = system_.potential;
  for (Index e = 0; e < envs.size(); ++e) {
    EnvStatus& now = envs[e];
    if (now.state != EnvState::running) continue;
    if (const std::string gone = system_.gone_for_good(r, e); !gone.empty()) {
      envs.fail(e, gone);
      continue;
    }
    // While supports move, energies rise with their work and say nothing.
    const double energy = std::exchange(now.arrived, r.support_gap[e] == 0) ? now.energy : INFINITY;
    const double relative = wanted(e), force = system_.convergence.largest_force(r, e);
    const bool energy_alone = options_.is_static && !potential.lags() && !potential.freezes() && !system_.slides(e);
    if (system_.solved(r, e, relative, now.step) && !(energy_alone && saddle_.waits(e, now.concave))) {
      now.state = now.whole ? EnvState::solved : EnvState::settled;
      continue;
    }
    const bool by_energy = !now.whole || (now.concave > 0 && now.concave < 1);
    const ProgressWatch::Sight sight = progress_.look(e, iteration, force, energy, by_energy);
    // What is kept lies where the energy is lowest, unless it is nearer than the coupled iteration has ever begun.
    if (sight.falls && (nearest_force_[e] > now.couple_below || system_.rows.loose[e])) nearest_force_[e] = INFINITY;
    if (now.may_couple && r.support_gap[e] == 0) keep_nearest(e, force, q);
    if (wants_coupled(e, iteration, r, relative, sight, now)) {
      if (std::isfinite(nearest_force_[e])) {
        copy_blocks(nearest_q_, system_.model.env_blocks[e], system_.model.env_blocks[e + 1], q);
        energies_.forget(e);
      }
      now.state = EnvState::stuck;
      continue;
    }
    now.circles = sight.turns && !potential.lags();  // friction has ways of its own: the coupled iteration, rounds of frozen forces
    const bool hopeless = now.coupled > 0 && !now.may_couple && sight.idle >= tuning::kHopeless;
    if (iteration < options_.iterations && !hopeless) continue;
    const Convergence::Worst worst = system_.convergence.worst(r, e, relative);
    std::ostringstream why;
    why << "Newton stopped after " << iteration << " iterations with a force residual of " << worst.force << " N on '"
        << system_.model.bodies[worst.body].name << "' (wanted " << worst.tolerance << " N)";
    if (r.support_gap[e] > 0) why << "; supports are " << r.support_gap[e] << " m from their targets";
    envs.fail(e, why.str());
  }
}

void Outlook::keep_nearest(Index env, double force, const device::Buffer<Vec3>& q) {
  if (force >= nearest_force_[env]) return;
  nearest_force_[env] = force;
  if (nearest_q_.size() != q.size()) nearest_q_.copy_from(q);
  copy_blocks(q, system_.model.env_blocks[env], system_.model.env_blocks[env + 1], nearest_q_);
}

bool Outlook::needs_jacobian(Index env, Index iteration, const Residual& r, double wanted, const EnvStatus& now) {
  const CreepWatch::Sight sight =
      creep_.look(env, iteration, system_.convergence.largest_force(r, env) / now.force, system_.convergence.over(r, env, wanted), now.alpha);
  if (sight.creeps) linear_.distrust(env);
  return sight.creeps || (sight.linear && linear_.ready(env) && (now.whole || !system_.potential.lags()));
}

// With the whole Jacobian: the energies of two iterates with lagged quantities of their own are not comparable, steps may run in circles; what
// creeps although nothing is missing from H + U is on its way through an instability, and gets there; so does what falls to ever lower energies
// along negative curvature. With something frozen: where the coupled iteration has failed before, once nothing falls any more, or nearer.
bool Outlook::wants_coupled(Index env, Index iteration, const Residual& r, double wanted, const ProgressWatch::Sight& sight, const EnvStatus& now) {
  const bool refused = now.refused >= tuning::kRefused, idle = refused || sight.idle >= tuning::kWholePatience;
  if (now.whole && (idle || iteration >= options_.iterations)) return true;
  if (now.whole && (sight.falls || !system_.potential.freezes())) return false;
  if (!now.may_couple || r.support_gap[env] > 0 || !(sight.circles || refused || needs_jacobian(env, iteration, r, wanted, now))) return false;
  return now.coupled == 0 || idle || (!sight.falls && nearest_force_[env] < now.couple_below);
}

}  // namespace mortise::solver
