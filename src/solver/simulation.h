#pragma once
// Time stepping: one step of the scene at a time, halved and retried when it does not converge, undone when it fails.
#include <functional>

#include "base/archive.h"
#include "base/field_sinks.h"
#include "solver/adjoint.h"
#include "solver/newton.h"
#include "solver/rehearsal.h"
#include "solver/tangent.h"

namespace mortise::solver {

// The user asked to stop; the state is that of the last finished step.
struct Stopped {};

// Forces at the accepted states. Those of a single environment are what Newton left; of several, which accept at different times, they are kept.
class AcceptedForces {
 public:
  void accept(const effects::StepInfo& info, const Linearised& at, const model::Model& model);
  const device::Buffer<Vec3>& of(std::size_t effect, const Linearised& at) const { return own_ ? gradients_[effect] : at.gradients[effect]; }
  const device::Buffer<Vec3>& sum(const Linearised& at) const { return own_ ? gradient_ : at.gradient; }

 private:
  bool own_ = false;
  std::vector<device::Buffer<Vec3>> gradients_;
  device::Buffer<Vec3> gradient_;
};

class Simulation {
 public:
  Simulation(model::Model& model, EffectList& effects, const Options& options);

  // Advances by one step of the scene. Throws Error(Exit::solve) when even the smallest substep fails, and Stopped when
  // `stop_asked` says so; either way the state is that before the call, and `report` tells how far it got. An environment among others that
  // fails is given up where it began the step (lost()), and the others go on; the error is thrown when none is left.
  void begin();  // what the first step begins with: effects find bodies that touch at the start
  void step(const std::function<bool()>& stop_asked, const StepReports& report);
  // From now on the environment stands still: it has come to its end.
  void rest(Index env) { resting_[env] = 1; }

  // From the next step on `others`, of the same degrees of freedom but with other parameters, go beside this one: when a step is solved they take
  // it too, by what is linear in the difference (follow.cpp). One environment.
  void lead(std::vector<Simulation*> others) { others_ = std::move(others); }

  // As one of those others: where it is to be right by a share in what the leader's numbers are wrong by. Before the first step.
  void mend(effects::Fault fault, double share);

  // Of a number of the state that the last step led to, with what acted in that step. Throws Failure where there is none. One environment.
  Adjoint adjoint(const Functional& of);

  // Why an environment was given up; empty where it was not.
  const std::string& lost(Index env) const { return lost_[env]; }
  double time(Index env = 0) const { return time_[env]; }
  Index steps_done(Index env = 0) const { return step_[env]; }
  const Clock& clock() const { return clock_; }
  const Newton& newton() const { return newton_; }
  std::vector<Rehearsed> rehearse() { return solver::rehearse(model_, newton_.potential()); }  // after begin()

  // Fields of the accepted state: displacement, support forces, force balance, and what every effect reports.
  void report(const FieldSinks& sinks);
  // Everything the next step depends on, of every environment; of those without an archive nothing is saved, or changed.
  void checkpoint(const std::vector<Archive*>& of);

 private:
  void attempt(effects::StepInfo info, EnvMask whose, const StepReports& report, const std::function<void()>& stop, std::vector<std::string>& why);
  void solve(const effects::StepInfo& info, const EnvMask& whose, const StepReports& report, const std::function<void()>& stop,
             std::vector<std::string>& why);
  std::vector<double> lost_energy(const effects::StepInfo& info) const;  // per environment [J]
  void accept(const effects::StepInfo& info, const std::vector<double>& lost);
  void lead_on(const effects::StepInfo& info);
  void follow(const effects::StepInfo& info, Simulation& leader, device::View<const Vec3> still);
  void report_balance(const FieldSinks& sinks);
  void report_effects(const FieldSinks& sinks, bool solved);
  std::vector<Vec3> resultants(const std::vector<Vec3>& g) const;

  model::Model& model_;
  EffectList& effects_;
  const Options options_;
  Clock clock_;
  Newton newton_;
  AcceptedForces forces_;
  std::vector<Simulation*> others_;
  device::Buffer<Vec3> apart_;        // of one that follows: how far beside the leader it was in the last step [m]
  std::unique_ptr<Tangent> tangent_;  // where there are others, or adjoints,
  Index tangent_step_ = -1;           // at the state that so many steps led to
  double resolved_ = 0;               // share of the leader's residual that goes into the way of one that follows
  bool refitted_ = false;             // parameters of effects were fitted to the solution of the step under way
  // Per environment:
  std::vector<std::string> lost_;
  EnvMask resting_;
  EnvMask solved_;                               // a step has been taken since start or restart: gradients are those of the state
  std::vector<double> support_work_, work_lag_;  // of the last step (StepEnergy) [J]
  std::vector<double> time_;
  std::vector<Index> step_;
};

}  // namespace mortise::solver
