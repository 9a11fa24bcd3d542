#pragma once
// Newton's method on the incremental potential Phi(q) with supports, in all environments at once: a loop over strategies.
//
//   residual   r = P grad Phi                          [N]; when it is small enough: convergence.h
//   Hessian    H with a share of its negative curvature: curvature_policy.h
//   direction  (P H P + I - P) d = -P (g + H c)        c = (I - P)(target - q): what the supports still have to move; direction.h, linear.h
//   step       q <- q + alpha (d + c)                  line_search.h
//
// Lagged quantities (friction's normal forces) are first taken from every iterate, with U, what their change adds to the Jacobian: then they are
// those of the solution. An environment that does not get there goes on with rounds in which they are frozen (lag_loop.h). Where iterations creep,
// coupled.h goes on with differences of forces in the place of the Jacobian (creep_watch.h).
#include <functional>
#include <memory>

#include "solver/coupled.h"
#include "solver/direction.h"
#include "solver/first_guess.h"
#include "solver/lag_loop.h"
#include "solver/line_search.h"
#include "solver/moving_policy.h"
#include "solver/newton_trace.h"
#include "solver/outlook.h"
#include "solver/saddle_policy.h"

namespace mortise::solver {

class Newton {
 public:
  using Search = LineSearch;  // the globalisation: another one has its begin(), end() and Forces
  Newton(model::Model& model, EffectList& effects, const Options& options, Clock& clock);

  // The state at model.q with its own lagged quantities, in the environments of `whose`: what a step starts from. Effects' begin_step must have run.
  void begin(const EnvMask& whose);
  // From where begin() or an earlier solve() left them to the minimisers, in the environments of `whose`: q(), and envs() that say how it ended.
  // With a single environment a failure is thrown. `stop` is asked between iterations and may throw.
  void solve(const effects::StepInfo& info, const StepReports& report, const std::function<void()>& stop, const EnvMask& whose);

  // May the step be cut? Then what comes no nearer fails before long.
  void may_cut(bool yes) { may_cut_ = yes; }

  // at() holds what is frozen and sampled of the environments of `whose`, of which some may have been left out while others went on.
  void hold(const EnvMask& whose);

  // As if solve() had ended at q, from the accepted state: its forces, samples and energies.
  void end_at(const device::Buffer<Vec3>& q);

  const device::Buffer<Vec3>& q() const { return q_; }
  const EnvTable& envs() const { return envs_; }
  // All effects at q(), sampled: the gradient over all blocks (at a held block: the support's force), and each effect's share.
  Linearised& at() { return at_; }
  const Linearised& at() const { return at_; }
  const EnergyLedger& energies() const { return energies_; }
  Potential& potential() { return system_.potential; }
  System& system() { return system_; }
  std::string linear_solver() const { return linear_->name(); }
  // The environments of `whose` accept q().
  void accept(const EnvMask& whose) { energies_.accept(whose, at_); }
  void end_step(const EnvMask& whose) { linear_->end_step(whose); }
  void checkpoint(Archive& archive) { linear_->checkpoint(archive), energies_.checkpoint(archive); }
  const std::string& linear_reason() const { return linear_choice_.reason; }

 private:
  void fail(Index env, const std::string& reason);
  EnvMask changing() const;
  void check_failed();
  void iterate(const effects::StepInfo& info, const StepReports& report, const std::function<void()>& stop);
  std::function<void(device::Fetch&)> ask_of_way();
  Search::Forces forces_beside(const Residual& r);
  void couple(Index round, const effects::StepInfo& info, const StepReports& report, const std::function<void()>& stop);
  void solve_coupled(const effects::StepInfo& info, const StepReports& report, const std::function<void()>& stop);
  void lag_here(const EnvMask& whose);
  void freeze(Index env);
  bool refresh(Index round, const StepReports& report);
  // Where nothing is frozen, energies themselves tell which steps of what only contact holds are good ones (loose_hold.h).
  bool held_loosely(Index env) const { return system_.rows.loose[env] && system_.potential.freezes(); }
  LooseHold::Left left(const Residual& r, Index env) const {
    return {system_.convergence.largest_force(r, env), system_.convergence.loose_sum(r, env)};
  }
  double wanted(Index env) const { return envs_[env].whole ? lag_.finest() : lag_.relative(env); }
  // How far the environments of `whose` are.
  void note(const Residual& r, const std::function<double(Index)>& relative, const EnvMask& whose, const StepReports& report) const;

  System system_;
  const model::Model& model_;
  const Options& options_;
  EnvTable envs_;
  LinearChoice linear_choice_;
  std::unique_ptr<Linear> linear_;
  CurvaturePolicy curvature_;
  Direction direction_;
  MovingPolicy moving_;
  SaddlePolicy saddle_;
  EnergyLedger energies_;
  Outlook outlook_;
  Search line_search_;
  FirstGuess first_guess_;
  LagLoop lag_;
  Coupled coupled_;
  NewtonTrace trace_;

  Linearised at_, beside_;  // at q_; at states beside it
  EnvMask held_;            // environments of which at_ holds more than forces
  device::Buffer<Vec3> q_;
  bool may_cut_ = true;
  bool foreseen_ = false;  // q_ is a state that effects have foreseen
  bool stays_ = false;     // at_ was filled at q_
  Index last_ = 0;         // iterations of the last solve
  EnvMask fresh_;          // environments that stand where the step begins
};

}  // namespace mortise::solver
