#pragma once
// A body that flies, or slides on what does not turn, keeps its spin, however fast it goes besides; of the energy of that the time step takes what
// turning_loss.h says, and nothing gives it back. With omega what it turns with, and phi = |omega| h,
//
//     lost = sum over the steps of min(2 phi^2, 1) |omega|^2     (backward Euler; BDF2: phi^4 / (1 + 4 phi^2)),
//
// over the most |omega|^2 that it had so. It spins on what it slides over where it turns about the direction of the force there. It counts once it
// has turned by kSpun so, or has in turning kTurns of its energy of motion. Bodies on a joint without a motor spin while nothing touches them; these
// have their turning from what touches them: each time by itself.
#include <vector>

#include "audit/moving_body.h"
#include "base/archive.h"
#include "model/input.h"

namespace mortise::audit {

class SpinLoss {
 public:
  explicit SpinLoss(const model::ModelInput& input) : integration_(integration_of(input.scene)) {}
  void state(const std::vector<MovingBody>& bodies);
  void step(bool first_order);  // that led to that state
  double share() const;         // of the body where it is most
  void checkpoint(Archive& archive);

 private:
  struct Spin {
    double most = 0, lost = 0;     // [1/s^2]
    double first = 0, second = 0;  // lost by the last step, by its order
    double angle = 0;              // turned so far [rad]
    double turned = 0, moved = 0;  // the most that it turned with, and had of energy of motion then [J]
    double share() const;
  };
  Integration integration_;
  std::vector<Spin> spins_;  // by body
  double ended_ = 0;         // the largest share of those before
};

}  // namespace mortise::audit
