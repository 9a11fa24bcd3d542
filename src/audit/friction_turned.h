#pragma once
// Friction acts along the way of a whole step. Where what slips goes round a bend it points half as far aside at the end of a step as it turns in it:
// with F the sum of friction's forces where two bodies slip, u its direction in a state,
//
//     turned = |u_1 - u_0| / 2 * |F| / max sum |f|     over all that rubs between them,
//
// no more than in the steps just before: a corner is none for longer. Slip that goes every way, as under what spins, has no direction.
#include <cmath>
#include <map>
#include <vector>

#include "audit/friction_pairs.h"
#include "base/archive.h"

namespace mortise::audit {

class FrictionTurned {
 public:
  void state(const std::vector<Rubbing>& rubs);
  double share() const { return most_; }  // the largest so far; NaN where nothing slipped two steps long
  void checkpoint(Archive& archive);

 private:
  struct Pair {
    double u[3] = {0, 0, 0}, turned[3] = {0, 0, 0}, largest = 0;  // u and turned of the last steps; the largest sum |f| [N]
  };
  std::map<Bodies, Pair> pairs_;
  double most_ = NAN;
};

}  // namespace mortise::audit
