#pragma once
#include <string>
#include <vector>

#include "audit/measured_body.h"
#include "base/archive.h"
#include "base/snapshot.h"

namespace mortise::run {

// Ends an episode: watches the conditions of environments.reset in every state.
class ResetWatch {
 public:
  ResetWatch(const std::vector<Params>& conditions, const model::ModelInput& input);

  // Before a run, whose first state has only a part of what is reported later: throws Error(Exit::scene) for a quantity of what the scene does not
  // have.
  void check(const Snapshot& start) const;
  // `step`: of the episode, 0 at its start, where nothing has been judged yet. Throws Error(Exit::scene) for a quantity that nobody reports.
  void see(long step, double time, const Snapshot& said, const std::vector<double>& points);
  bool due() const { return due_ >= 0; }
  std::string reason() const;  // "body ball z = -0.021 below -0.02"
  void checkpoint(Archive& archive);

 private:
  std::vector<Params> conditions_;
  const Params scene_;
  std::vector<audit::MeasuredBody> bodies_;  // one per condition of a body, in their order
  long due_ = -1;                            // number of the condition
  double value_ = 0;                         // of what it watches
};

}  // namespace mortise::run
