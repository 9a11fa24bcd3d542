#pragma once
// An effect is one term of the incremental potential
//     Phi(q) = sum over effects of Phi_effect(q)   [J],      forces = -grad Phi   [N],
// minimised over the degrees of freedom q (3-vectors) once per step. The solver knows effects only through this interface and their kinds; an
// effect exists only when the scene names it, and knows no other effect. It holds parameters, and what the accepted states so far left behind;
// what belongs to one state q is a Linearisation, which the caller owns.
#include <string>
#include <string_view>
#include <vector>

#include "base/archive.h"
#include "base/field_sinks.h"
#include "device/device.h"
#include "effects/curvature.h"
#include "effects/fault.h"
#include "effects/integrator.h"
#include "effects/kind.h"
#include "effects/linearisation.h"

namespace mortise::effects {

using device::View;
using Positions = View<const Vec3>;  // one 3-vector per block

// What a motor holds of energy, of every environment [J].
struct Held {
  std::vector<double> at_last, begin, end, along;
};

struct StepInfo {
  double t0 = 0;   // time at the start of the step [s]
  double dt = 0;   // its length [s]; in static mode a share of pseudo-time
  Index step = 0;  // number of the step, from 0
  bool is_static = false;
  std::vector<std::uint8_t> whose{};        // environments that take it, or empty: all do
  std::vector<double> begins{};             // of every environment [s], or empty: all begin at t0
  std::vector<std::uint8_t> first_order{};  // environments in which integrators of second order take this step by their first-order form; empty: none
  std::vector<Integrator> integrators{};    // of every environment, as the scene's integrator says; empty: backward Euler
  Integrator integrator(Index env) const { return integrators.empty() ? backward_euler(dt) : integrators[env]; }
  double t0_of(Index env) const { return begins.empty() ? t0 : begins[env]; }
  double t1_of(Index env) const { return t0_of(env) + dt; }
  bool of_first_order(Index env) const { return !first_order.empty() && first_order[env] != 0; }
  bool taken_by(Index env) const { return whose.empty() || whose[env] != 0; }
};

// `check --plan`: what an effect holds besides its linearisations.
struct PlanItem {
  std::string what;  // "pairs", "samples", ...
  std::size_t bytes;
};

class Effect {
 public:
  virtual ~Effect() = default;
  virtual const Kind& kind() const = 0;
  std::string_view name() const { return kind().name; }
  virtual std::vector<PlanItem> plan() const { return {}; }

  // All effects exist, and supports are set: find what the model provides. Once, before everything else.
  virtual void connect() {}
  // Of an integrator: what it takes for rates in a step of that length. Before any effect begins the step.
  virtual void integrate(StepInfo& step) const { (void)step; }
  // Prepare the step of the environments that take it from the accepted state (model.q holds it). What others keep stays as it is.
  virtual void begin_step(const StepInfo&) {}

  virtual std::unique_ptr<Linearisation> linearisation() const { return std::make_unique<Linearisation>(); }
  // Fill `at` at q, as far as wanted.
  virtual void linearise(Positions q, Want want, Linearisation& at) = 0;
  // The next state at which `at` is filled with forces may be q: what the host has to hear of that comes with `fetch`.
  virtual void foresee(Positions q, Linearisation& at, device::Fetch& fetch) { (void)q, (void)at, (void)fetch; }
  // Fill the contact samples of the state of `at`.
  virtual void sample(Linearisation& at) { (void)at; }
  // And how they change with the state.
  virtual void sample_changes(Linearisation& at) { (void)at; }
  // Are the matrix and what it lacks of `at`, linearised with everything that moves, the whole Jacobian of the forces?
  virtual bool complete(const Linearisation& at) const { return (void)at, true; }
  // Of a follower: the contact effect whose samples it wants. Takes over the lagged quantities (friction's normal forces) from them; `at` keeps
  // them while it is filled at other states.
  virtual std::string_view follows() const { return {}; }
  virtual void lag(const model::ContactView& samples, Linearisation& at) { (void)samples, (void)at; }

  // Add the energy [J] at q, on a way from the state of `frozen` with what is frozen there, to the values of the environments.
  virtual void energy(Positions q, const Linearisation& frozen, device::EnvValues per_env) = 0;
  std::vector<double> energies_now(Positions q, const Linearisation& frozen, Index envs);  // of every environment,
  double energy_now(Positions q, const Linearisation& frozen, Index envs);                 // and of all
  // Lower alpha of the environments to the longest step alpha dq (alpha <= 1) from the state of `at` that keeps the energy finite.
  virtual void max_step(View<const Vec3> dq, Linearisation& at, device::EnvValues alpha) { (void)dq, (void)at, (void)alpha; }
  // Once that is fetched: ready `at` for energies on the way that was asked for last.
  virtual void reach(Linearisation& at) { (void)at; }

  // Of what turns: by which angle at most on the way from q [rad]; and that way as an arc, as straight ones stretch what is stiff by half its square.
  virtual void turning(Positions q, Positions way, device::EnvValues most) { (void)q, (void)way, (void)most; }
  virtual void bend(Positions q, View<Vec3> way) { (void)q, (void)way; }

  // Of an integrator: where everything would be at the end of the step under way if nothing acted on it [m].
  virtual Positions carried() const { return {}; }
  // Of an integrator: every step should lose energy (solver/energy_ledger.h).
  virtual bool loses_energy() const { return false; }
  // Of an integrator: is the step under way of second order? Then what it adds of its own over the step to q, T(q) - T(q_n) - M a . (q - q_n), is not
  // minus its energy at q; it goes to `gain`, and the kinetic energy T(q_n) that there was to `there` [J].
  virtual bool second_order(Index env) const { return (void)env, false; }
  // Of an integrator of second order: has it no history yet, so that the next step begins with one of first order?
  virtual bool starts(Index env) const { return (void)env, false; }
  // Of supports: are points free in a step as long as this one that begins where it does, and were held in the one before?
  virtual bool lets_go(const StepInfo& step, Index env) const { return (void)step, (void)env, false; }
  virtual void own_gain(Positions q, device::EnvValues gain, device::EnvValues there) { (void)q, (void)gain, (void)there; }
  // Of a motor that holds energy and reports it: how much at the last accepted state, at the beginning of the step under way (which may pull
  // elsewhere) and at q, its end; and the gradient of what holds it, at q, along the way `move` of the step.
  virtual void held_energy(Positions q, Positions move, device::Fetch& fetch, Held& held) { (void)q, (void)move, (void)fetch, (void)held; }
  // Parameters that must fit the solution q of the very step are changed; raises per_env where the step has to be solved again with them,
  // from q or from its start. `at`: q. Nothing outlives a step that is given up.
  enum class Refit { none, from_here, from_start };
  virtual void refit(Positions q, const Linearisation& at, std::vector<Refit>& per_env) { (void)q, (void)at, (void)per_env; }
  // Why q is no state of the model although forces balance there: sets the reason of environments where it is none.
  virtual void object(Positions q, std::vector<std::string>& per_env) { (void)q, (void)per_env; }
  // The environments that took the step accept it at q, where `at` was filled and sampled.
  virtual void end_step(const StepInfo& info, Positions q, const Linearisation& at) { (void)info, (void)q, (void)at; }
  // After that: parameters may be fitted to what was found, at the cost of at most `budget` [J] of energy of every environment, for the next step;
  // what is reported belongs to the state that was solved.
  virtual void adapt(const StepInfo& info, const std::vector<double>& budget, const Linearisation& at) { (void)info, (void)budget, (void)at; }
  // Of the accepted state, where `at` was filled and sampled: to every environment's sink what it would be told alone.
  virtual void report(const FieldSinks&, const Linearisation& at) { (void)at; }
  // Of a scene with one environment that goes beside another: from its first step on mend that fault by a share of it; who does not have it need not
  // know.
  virtual void mend(Fault fault, double share) { (void)fault, (void)share; }
  // And when it has begun a step: the leader's effect of the same kind, whose solution of the step is q.
  virtual void keep_pace(const Effect& leader, Positions q) { (void)leader, (void)q; }
  // Values are told apart by environment.
  virtual void checkpoint(Archive&) {}
};

inline std::vector<double> Effect::energies_now(Positions q, const Linearisation& frozen, Index envs) {
  std::vector<double> per_env(envs, 0.0);
  device::Fetch fetch;
  energy(q, frozen, {per_env, fetch});
  fetch.now("energies");
  return per_env;
}

inline double Effect::energy_now(Positions q, const Linearisation& frozen, Index envs) {
  double total = 0;
  for (double e : energies_now(q, frozen, envs)) total += e;
  return total;
}

}  // namespace mortise::effects
