#pragma once
// Goes beside a run, and tells at its end what has to be added to its quantities because of what the run leaves out. Every source of errors is a model
// beside it that leaves a hair less of it out (solver/follow.cpp):
//
//   mesh      quadratic elements that take away a share e of what the solution has left of their equations
//   gap       contact as if surfaces stood apart by (1 + e) of their gaps: dQ/dg g is what the gap makes of Q
//   time      an integrator by a share e on the way to the next order
//   Newton's method, its linear systems, lagged friction    the run's own equations, with a share e of what they have left taken away
//
// What Q is different by there, over e, is the estimate: to first order, of all quantities, whatever they are made of. Scenes without a memory are
// joined at the last step.
#include <memory>
#include <string>
#include <vector>

#include "engine/api.h"
#include "study/course.h"
#include "study/error_budget.h"

namespace mortise::study {

class ErrorWatch {
 public:
  struct Means {
    const engine::Api* api;
    std::string folder;       // where it may write, until its end
    bool mesh_in_motion;      // quadratic elements beside every step cost more than the run itself
    std::string no_memory{};  // why a run that has a memory was not seen from its start
  };
  // The leader and its input outlive it.
  ErrorWatch(engine::Engine& leader, const model::ModelInput& input, std::vector<Quantity> quantities, Means means);

  void before_step();
  void after_step(const solver::StepReport& report, bool frame);
  // After the last step.
  ErrorBudget end();

 private:
  struct Source {
    std::string name;
    Recording* beside_of;               // what it differs from
    std::unique_ptr<Course> companion;  // null: not estimated,
    std::string why_not;                // which is why
  };
  void join();
  Source source(const std::string& name, const model::ModelInput& input, Recording& beside_of) const;
  ErrorPart part(Source& s, const Quantity& q, double value);

  engine::Engine& leader_;
  const model::ModelInput& input_;
  const std::vector<Quantity> quantities_;
  const Means means_;
  const bool moves_, contact_;
  const long steps_;
  bool remembers_ = false, joined_ = false;
  std::string why_not_;  // nothing can be told
  double seconds_ = 0;
  std::unique_ptr<Recording> own_;
  std::unique_ptr<Course> shadow_;
  std::string no_shadow_;
  std::vector<Source> sources_;
};

}  // namespace mortise::study
