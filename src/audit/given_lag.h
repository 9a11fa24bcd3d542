#pragma once
// Forces of what goes as it is told (pins, kinematic drives). Backward Euler gives it at the end of a step the acceleration of the step before,
// a_n = (x_n - 2 x_n-1 + x_n-2)/h^2: the force that this takes is late by h. Of a motion that is smooth,
//
//     lag = sum m |a_n - a_n-1| / sum F,
//
// over the steps in which a changes by less than itself, is 2 pi/n of a sine of n steps but for where it turns; F: the force that holds the body in
// that state, or all that touches it, beside which its own inertia may be nothing. Where a motion starts or stops at once no step says anything of
// the force.
#include <vector>

#include "audit/moving_body.h"
#include "base/archive.h"
#include "model/input.h"

namespace mortise::audit {

class GivenLag {
 public:
  explicit GivenLag(const model::ModelInput& input);
  void state(const std::vector<MovingBody>& bodies, const std::vector<double>& forces);  // F of every body [N]
  double value() const;  // of the body where it is most; NaN where none is told to move, or without backward Euler
  void checkpoint(Archive& archive);

 private:
  bool backward_euler_;
  std::vector<double> a_;           // 3 per body, of the last state [m/s^2]
  std::vector<double> late_, all_;  // per body: sums of both sides [N]
  long states_ = 0;
};

}  // namespace mortise::audit
