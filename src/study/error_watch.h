#pragma once
// Goes beside a run, and tells at its end what has to be added to its quantities because of what the run leaves out. Every source of errors is a model
// beside it that leaves a hair less of it out (solver/follow.cpp):
//
//   mesh          richer elements that take away a share e of what the solution has left of their equations
//   gap           contact as if surfaces stood apart by (1 + e) of their gaps: dQ/dg g is what the gap makes of Q
//   time          an integrator by a share e on the way to the next order
//   facets        of stiff bodies: shorter edges, otherwise like mesh; of soft ones: middles of edges by e on the way to the round surface
//   integration   more points, otherwise like mesh
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
    std::string folder;  // where it may write, until its end
    bool all_in_motion;  // else not what costs more than the run itself
  };
  // The leader and its input outlive it.
  ErrorWatch(engine::Engine& leader, const model::ModelInput& input, std::vector<Quantity> quantities, Means means);

  void before_step();
  void after_step(const solver::StepReport& report, bool frame);
  // After the last step.
  ErrorBudget end();

 private:
  // The leader, or a shadow of it.
  struct Line {
    engine::Engine* engine;
    Recording* recording;
    std::unique_ptr<Course> course{};  // of a shadow
    std::vector<engine::Engine::Beside> led{};
    bool lost() const { return course && !engine->lost().empty(); }
  };
  struct Source {
    std::string name;
    const Line* line;                   // what it goes beside
    std::unique_ptr<Course> companion;  // null: not estimated,
    bool whole;                         // what the line makes of the same displacements is a part of it
    std::string why_not;                // which is why
  };
  void join();
  void add(const std::string& name, Line& line, const model::ModelInput& input, solver::Departure by, bool whole = false);
  void add_shadow(const std::string& name, const model::ModelInput& input, const std::string& why_not);
  void none(const std::string& name, const std::string& why_not);
  std::unique_ptr<Course> course(const model::ModelInput& input);
  ErrorPart part(const Source& s, const Quantity& q, double value) const;

  engine::Engine& leader_;
  const model::ModelInput& input_;
  const std::vector<Quantity> quantities_;
  const Means means_;
  const bool moves_, contact_;
  const long steps_;
  bool remembers_ = false, joined_ = false;
  std::string why_not_;  // nothing can be told
  double seconds_ = 0;
  int files_ = 0;
  std::unique_ptr<Recording> own_;
  std::vector<std::unique_ptr<Line>> lines_;  // the leader first
  std::vector<Source> sources_;
};

}  // namespace mortise::study
