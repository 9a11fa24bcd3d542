#pragma once
// What friction that turns round costs with BDF2. Where slip turns round within a step the force does so half a step late: no friction between that
// of before and that of after it lets the velocity of BDF2 come to rest there, as it does with backward Euler. The body is too fast by the change
// that friction makes in a step, h F / m, every time, and goes on so until slip turns round again. Of a free body on one that is shaken, of all slips
// between two turns, with t how long they lasted and s how far they went,
//
//     2 sum h (F / m) t / sum s
//
// is about the share of its slip that is too much (within a factor of two). Where it sticks between, a new slip begins.
#include <cmath>
#include <vector>

#include "audit/moving_body.h"
#include "base/archive.h"
#include "model/input.h"

namespace mortise::audit {

class SlipReversal {
 public:
  explicit SlipReversal(const model::ModelInput& input) : integration_(integration_of(input.scene)) {}
  void state(const Snapshot& said, const std::vector<MovingBody>& bodies);
  double share() const;  // of the body where it is most; NaN where no slip turned round twice, or without BDF2
  void checkpoint(Archive& archive);

 private:
  // Of a body: its velocity of slip in the last state and the fastest so far [m/s]; has the slip under way begun with a turn, how far [m] and how
  // long [s] it has gone on, and the largest F / m in it [m/s^2]; the two sums [m].
  struct Body {
    double slips[3] = {}, fastest = 0, turned = 0, way = 0, time = 0, rate = 0, late = 0, gone = 0;
    void begin(bool by_turning) { turned = by_turning, way = time = rate = 0; }
  };
  Integration integration_;
  std::vector<Body> bodies_;
};

}  // namespace mortise::audit
