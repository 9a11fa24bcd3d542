#pragma once
// The way off a saddle of the energy. There the Hessian is indefinite, and the matrix keeps only a part of its negative curvature
// (curvature_policy.h): the iterate leaves along an unstable motion by a share of its distance, so that a thousandth of a nanometre takes a hundred
// iterations to a millimetre (edges that meet exactly parallel, columns beyond their load). Directions are then all of that motion, as powers of a
// matrix turn vectors into its first eigenvector, and downhill; ever longer ways along them are tried, until the line search cuts one. In equilibrium
// a saddle is no solution, though nothing moves there: rounding alone has to find the way out.
#include <algorithm>
#include <utility>
#include <vector>

#include "solver/tuning.h"

namespace mortise::solver {

class SaddlePolicy {
 public:
  explicit SaddlePolicy(Index envs) : rows_(envs) {}

  void begin(Index env) { rows_[env] = {}; }
  // What the next way is to be multiplied by. alpha, concave: share of the last step that was taken, and of negative curvature in its matrix;
  // force: the residual that it led to [N].
  double choose(Index env, double alpha, double concave, double force) {
    Row& row = rows_[env];
    const bool leaves = alpha == 1 && row.full && concave < 1 && row.before > 0 && force > row.before;
    row.full = alpha == 1;
    row.before = std::exchange(row.force, force);
    row.stretch = leaves ? std::min(row.stretch * tuning::kStretch, tuning::kLongest) : 1;
    return row.stretch;
  }
  // The residual is small enough, and the last matrix had that share of negative curvature: is it worth going on? One that had all of it was
  // definite.
  bool waits(Index env, double concave) { return concave < 1 && rows_[env].waited++ < (concave > 0 ? tuning::kWaits : tuning::kWaitsConvex); }

 private:
  struct Row {
    Index waited = 0;              // iterations
    double force = 0, before = 0;  // the residual of the last iterate, and of the one before: shares of curvature come and go by turns
    double stretch = 1;
    bool full = false;  // so was the step before the last: then more negative curvature was tried
  };
  std::vector<Row> rows_;  // environments
};

}  // namespace mortise::solver
