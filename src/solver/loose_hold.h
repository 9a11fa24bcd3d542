#pragma once
// Statics, and a body that nothing but contact holds: along the surface it rests on it meets hardly any stiffness, and what it meets the frozen
// matrix does not know, since that is how samples turn and slide. Newton's steps then lead far along it and disturb everything else. Such bodies
// are held to where an iterate has them,
//     A += s k I,    k = mean stiffness of their rows [N/m],
// more or less as that turns out (Levenberg, Marquardt). A step is far when k |dq| is much more than any force there is; a far one that raises the
// residual is not taken, and one that hardly lowers it is the last so loose; neither is said of steps on which supports move, which raise forces by
// what they do. The hold falls again where what is left of the residual is what it held back, s k |dq|. The residual itself knows nothing of it, so
// that a solution is one of the scene.
//
// Only where samples are frozen, so that energies of two iterates are not those of one potential. Elsewhere the line search goes down the energy, and
// a step that first raises the residual is the way: a soft ball of facets between two plates rolls by a millimetre until it lies on both, in 21
// iterations; held it crept by two micrometres at a time.
#include <algorithm>
#include <vector>

#include "solver/tuning.h"

namespace mortise::solver {

class LooseHold {
 public:
  explicit LooseHold(Index envs) : rows_(envs) {}

  void begin_solve() { rows_.assign(rows_.size(), {}); }
  void set_stiffness(Index env, Index count, double stiffness) { rows_[env].count = static_cast<double>(count), rows_[env].stiffness = stiffness; }

  // What is left of an environment's residual [N].
  struct Left {
    double force = 0;  // where it is largest,
    double sum = 0;    // and of a whole body: what falls as a whole, by a little on each of thousands of nodes, goes far for a reason
  };
  // Of a step of `length` [m].
  bool far(Index env, const Left& left, double length) const { return rows_[env].stiffness * length > std::max(tuning::kFar * left.force, left.sum); }
  // After a step of share alpha, and of `length` at full length.
  void look(Index env, const Left& before, const Left& after, double alpha, double length) {
    if (alpha < 1 || !(before.force > 0)) return;
    Row& row = rows_[env];
    const double held_back = 2 * row.scale * row.stiffness * length;
    if (after.force > tuning::kAstray * before.force && after.force > held_back && far(env, before, length))
      tighten(env);
    else if (held_back > after.force || (after.sum > 0 && row.count * held_back > after.sum))
      row.scale /= tuning::kHoldFalls;
  }
  void tighten(Index env) {
    double& s = rows_[env].scale;
    s = s > 0 ? std::min(tuning::kLargestHold, s * tuning::kHoldGrowth) : tuning::kFirstHold;
  }
  // A far step that is not to be taken.
  bool astray(Index env, double before, double after) const { return after > tuning::kAway * before && rows_[env].scale < tuning::kLargestHold; }

  // Does what supports are about to grip flee meanwhile, on a step of `length` in a scene of that size [m]? The step is not taken, and until supports
  // stand it is held so that `force` [N] moves it as far as they still have to go, `way` [m].
  bool flees(Index env, double length, double size) const { return rows_[env].firm == 0 && length > tuning::kFlees * size; }
  void hold_firmly(Index env, double force, double way) { rows_[env].firm = force / way; }
  void let_go(Index env) { rows_[env].firm = 0; }

  double scale(Index env) const { return rows_[env].scale; }
  double firm(Index env) const { return rows_[env].firm; }

 private:
  struct Row {
    double scale = 0, stiffness = 0, firm = 0;  // s; k; beside s k [N/m]
    double count = 0;                           // of what is held
  };
  std::vector<Row> rows_;  // environments
};

}  // namespace mortise::solver
