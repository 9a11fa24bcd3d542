#pragma once
// Time stepping: one step of the scene at a time, halved and retried when it does not converge, undone when it fails.
#include <functional>

#include "base/archive.h"
#include "base/field_sink.h"
#include "solver/newton.h"
#include "solver/rehearsal.h"

namespace mortise::solver {

// The user asked to stop; the state is that of the last finished step.
struct Stopped {};

class Simulation {
 public:
  Simulation(model::Model& model, EffectList& effects, const Options& options);

  // Advances by one step of the scene. Throws Error(Exit::solve) when even the smallest substep fails, and Stopped when
  // `stop_asked` says so; either way the state is that before the call, and `report` tells how far it got.
  void begin();  // what the first step begins with: effects find bodies that touch at the start
  void step(const std::function<bool()>& stop_asked, StepReport& report);

  double time() const { return time_; }
  Index steps_done() const { return step_; }
  const Clock& clock() const { return clock_; }
  const Newton& newton() const { return newton_; }
  std::vector<Rehearsed> rehearse() { return solver::rehearse(model_, newton_.potential()); }  // after begin()

  // Fields of the accepted state: displacement, support forces, force balance, and what every effect reports.
  void report(FieldSink& sink);
  // Everything the next step depends on.
  void checkpoint(Archive& archive);

 private:
  void solve(const effects::StepInfo& info, StepReport& report, const std::function<void()>& stop);
  void accept();
  void report_balance(FieldSink& sink);
  std::vector<Vec3> resultants(const std::vector<Vec3>& g) const;

  model::Model& model_;
  EffectList& effects_;
  const Options options_;
  Clock clock_;
  Newton newton_;
  double support_work_ = 0;  // of the last step [J]
  double time_ = 0;
  Index step_ = 0;
  bool solved_ = false;  // a step has been taken since start or restart: gradients are those of the state
};

}  // namespace mortise::solver
