#pragma once
// Whether iterations get anywhere: they do while the residual falls, or the energy to ever lower values. One of them may rise meanwhile: forces on
// the way through an instability, energies of iterates that have frozen something of their own. Where neither does and the residual is that of the
// iterate before the last, again and again, they run in a circle between two states, and more of them are of no use.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "solver/tuning.h"

namespace mortise::solver {

class ProgressWatch {
 public:
  explicit ProgressWatch(Index envs) : rows_(envs) {}

  struct Sight {
    bool falls;    // the energy, to the lowest of these iterations
    Index idle;    // iterations since the last progress; in a circle as many as there could be
    bool turns;    // it came back to where it was before the last, more than once,
    bool circles;  // and so often that it runs in a circle between two states
  };
  // force: residual [N]; energy: of the iterate before [J], infinite where supports still moved; by_energy: does a falling energy count?
  Sight look(Index env, Index iteration, double force, double energy, bool by_energy) {
    Row& row = rows_[env];
    if (iteration == 0 || force < tuning::kProgress * row.force) row.force = force, row.since = iteration;
    if (iteration <= 1) row.energy = INFINITY;
    const bool falls = by_energy && iteration > 0 && energy < row.energy;
    if (iteration > 0) row.energy = std::min(row.energy, energy);
    if (falls) row.since = iteration;
    const bool same = iteration > 1 && !falls && std::abs(force - row.last[0]) <= tuning::kSameForce * force;
    row.circling = same ? row.circling + 1 : 0;
    row.last = {row.last[1], force};
    const bool circles = row.circling >= tuning::kCircles;
    return {falls, circles ? tuning::kHopeless : iteration - row.since, row.circling >= tuning::kTurns, circles};
  }

 private:
  struct Row {
    double force = 0, energy = INFINITY;  // least so far
    Index since = 0;                      // iteration of the last progress
    std::array<double, 2> last{};         // residuals of the last two iterates [N]
    Index circling = 0;                   // iterations
  };
  std::vector<Row> rows_;  // environments
};

}  // namespace mortise::solver
