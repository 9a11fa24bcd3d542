#pragma once
// What friction that turns round costs with BDF2. Where slip turns round within a step the force does so half a step late: no friction between that
// of before and that of after it lets the velocity of BDF2 come to rest there, as it does with backward Euler. The body is too fast by the change
// that friction makes in a step, h F / m, every time, and goes on so until slip turns round again. Of a free body on one that is shaken, with t how
// long slips between two turns lasted and s how far all slips went,
//
//     2 sum h (F / m) t / sum s
//
// is about the share of its slip that is too much (within a factor of two). Where it sticks between, a new slip begins. Dry friction in the bearing
// of a joint to what is shaken does the same; nobody knows how much hangs on that, but its rate tells: in the step after the turn it changes by 2 h F
// / m less, or more, than in the step before.
#include <cmath>
#include <string>
#include <vector>

#include "audit/friction_pairs.h"
#include "audit/moving_body.h"
#include "base/archive.h"
#include "model/input.h"

namespace mortise::audit {

class SlipReversal {
 public:
  explicit SlipReversal(const model::ModelInput& input);
  void state(const Snapshot& said, const std::vector<MovingBody>& bodies);
  double share() const;  // of the body or joint where it is most; NaN where no slip turned round twice, or without BDF2
  void checkpoint(Archive& archive);

 private:
  // Of a body or joint: its velocity of slip in the last state and the fastest so far [m/s]; has the slip under way begun with a turn, how far [m]
  // and how long [s] it has gone on, and the largest F / m in it [m/s^2]; the two sums [m]. Of hinges radians stand for metres.
  struct Slip {
    double v[3] = {}, fastest = 0, turned = 0, way = 0, time = 0, rate = 0, late = 0, gone = 0;
    void begin(bool by_turning) { turned = by_turning, way = time = rate = 0; }
  };
  struct Bearing {
    double change = 0, before = 0;  // of its rate in the last step and in the one before that
  };
  void advance(Slip& slip, const Vec3& v, double rate) const;
  void bearing(std::size_t number, double v);
  struct Joint {
    std::string rate;  // its name
    std::size_t to;    // number of a body
    double size;       // of that [m]
  };
  Integration integration_;
  double creep_ = 0;        // slower is no slip of bodies [m/s]
  std::vector<Joint> dry_;  // whose bearings have dry friction
  std::vector<Slip> bodies_, joints_;
  std::vector<Bearing> bearings_;
};

}  // namespace mortise::audit
