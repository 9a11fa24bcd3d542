#pragma once
// Newton's method gains digits faster and faster near a solution; what does not is a sign that the matrix lacks something: iterations creep, or
// gain the same one or two digits each while more than one of them is still missing. Then the coupled iteration (coupled.h) may do better.
#include <vector>

#include "solver/tuning.h"

namespace mortise::solver {

class CreepWatch {
 public:
  explicit CreepWatch(Index envs) : slow_(envs, 0) {}

  struct Sight {
    bool creeps = false;  // the residual hardly falls any more
    bool linear = false;  // it falls by the same share each time, which one iteration cannot show
  };
  // left: the residual over that before the last iteration; over: the worst body's residual over its tolerance; alpha: of the last step.
  Sight look(Index env, Index iteration, double left, double over, double alpha) {
    if (iteration == 0) {
      slow_[env] = 0;
      return {};
    }
    slow_[env] = left > tuning::kFast ? slow_[env] + 1 : 0;
    return {slow_[env] >= tuning::kPatience && iteration >= tuning::kUsual,
            iteration > 1 && left < tuning::kFast && left > tuning::kQuadratic && alpha == 1 && over * left > 1};
  }

 private:
  std::vector<Index> slow_;  // iterations in a row that got nowhere
};

}  // namespace mortise::solver
