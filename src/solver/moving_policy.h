#pragma once
// Whether the next matrix is to have what the frozen one lacks: that samples turn and slide (effects/curvature.h). It costs derivatives of all of
// them and an unsymmetric system. Where it matters a full step leaves a good share of the residual, while Newton's method near a solution gains digit
// after digit; from the first that left more than a tenth on directions are those of the whole Jacobian, until a step is cut: far away they are no
// better, and more often uphill.
#include <vector>

#include "solver/tuning.h"

namespace mortise::solver {

class MovingPolicy {
 public:
  explicit MovingPolicy(Index envs) : rows_(envs) {}

  void begin(Index env) { rows_[env] = {}; }
  // alpha: share of the last step that was taken.
  bool choose(Index env, double alpha) {
    Row& row = rows_[env];
    const bool slow = row.before > 0 && row.force > tuning::kFast * row.before;
    return row.moving = alpha == 1 && (row.moving || slow);
  }
  // The residual from which the last step began [N].
  void see(Index env, double force) { rows_[env].before = rows_[env].force, rows_[env].force = force; }

 private:
  struct Row {
    double force = 0, before = 0;  // the last two
    bool moving = false;
  };
  std::vector<Row> rows_;  // environments
};

}  // namespace mortise::solver
