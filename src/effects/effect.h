#pragma once
// An effect is one term of the incremental potential
//     Phi(q) = sum over effects of Phi_effect(q)   [J],      forces = -grad Phi   [N],
// minimised over the degrees of freedom q (3-vectors) once per step. The solver knows effects only through this interface; an
// effect exists only when the scene names it, and knows no other effect.
#include <string>
#include <string_view>
#include <vector>

#include "base/archive.h"
#include "base/field_sink.h"
#include "device/device.h"
#include "effects/curvature.h"
#include "linalg/stencils.h"

namespace mortise::effects {

using device::View;
using Positions = View<const Vec3>;  // one 3-vector per block

struct StepInfo {
  double t0 = 0;         // time at the start of the step [s]
  double dt = 0;         // its length [s]; in static mode a share of pseudo-time
  Index step = 0;        // number of the step, from 0
  bool is_static = false;
  double t1() const { return t0 + dt; }
};

// `check --plan`: what an effect will hold and launch.
struct Plan {
  struct Item {
    std::string what;  // "stencils", "samples", ...
    std::size_t bytes;
  };
  std::vector<Item> buffers;
  std::vector<std::string> kernels;
};

class Effect {
 public:
  virtual ~Effect() = default;
  virtual std::string_view name() const = 0;

  virtual void plan(Plan& out) const = 0;

  // Prepare the step from the accepted state (model.q holds it).
  virtual void begin_step(const StepInfo&) {}
  // Add the effect's energy [J] at q to the values of the environments.
  virtual void energy(Positions q, device::EnvValues per_env) = 0;
  double energy_now(Positions q, Index envs);  // of all environments
  // Fill gradient pieces and, as far as wanted, Hessian pieces at q; return the stencils.
  virtual linalg::StencilSet& assemble(Positions q, Curvature hessian) = 0;
  // Lower alpha of the environments to the longest step q + alpha dq (alpha <= 1) that keeps the effect's energy finite.
  virtual void max_step(Positions q, View<const Vec3> dq, device::EnvValues alpha) { (void)q, (void)dq, (void)alpha; }
  // Refresh quantities frozen during Newton (friction's normal forces) from q; true if the effect has any.
  virtual bool lag(Positions q) {
    (void)q;
    return false;
  }
  // Are the forces of assemble() the gradient of energy(), with nothing frozen at the state of assembly?
  virtual bool conservative() const { return true; }
  // Is energy() a store that gives back what it took? No: potentials of inertia, of friction, of loads.
  virtual bool stores_energy() const { return true; }
  // Do its forces on every body cancel? Those of elasticity do; weight, inertia and contact move bodies as a whole.
  virtual bool internal() const { return false; }
  // The step was accepted at q.
  virtual void end_step(Positions q) { (void)q; }
  // After that: parameters may be fitted to what was found, at the cost of at most `budget` [J] of energy, for the next step; what is
  // reported belongs to the state that was solved.
  virtual void adapt(double budget) { (void)budget; }
  // Before that: parameters that must fit the solution q of the very step are changed; says whether it has to be solved again with them, from q
  // or from its start. Nothing outlives a step that is given up.
  enum class Refit { none, from_here, from_start };
  virtual Refit refit(Positions q) {
    (void)q;
    return Refit::none;
  }
  // Why q is no state of the model although forces balance there; empty if it is one.
  virtual std::string objection(Positions q) {
    (void)q;
    return {};
  }
  virtual void report(FieldSink&) {}
  virtual void checkpoint(Archive&) {}
};

inline double Effect::energy_now(Positions q, Index envs) {
  std::vector<double> per_env(envs, 0.0);
  device::Fetch fetch;
  energy(q, {per_env, fetch});
  fetch.now();
  double total = 0;
  for (double e : per_env) total += e;
  return total;
}

}  // namespace mortise::effects
