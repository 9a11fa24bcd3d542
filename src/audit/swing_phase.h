#pragma once
// BDF2 keeps the energy of what swings, but not its time: with omega h small a swing of x'' = -omega^2 x is out of phase, after a time t, by
//
//     phi = 1/3 h^2 (omega^2 + w^2) omega t      (90 steps in a period, 22 periods: 0.22 rad, and as much of the amplitude)
//
// with w how fast the body turns: its blocks go on circles. Of stiff bodies on joints that go as no pin and no motor says, while they touch nothing,
// by their centres: omega^2 = - sum a' . v / sum v . v over the steps so far, a' what a changes by, which is nothing in flight, and w^2 of the same
// weights. Told in terms of the largest swing so far, of which |v|^2 + |a|^2 / omega^2 tells how much is left.
#include <vector>

#include "audit/moving_body.h"
#include "base/archive.h"
#include "model/input.h"

namespace mortise::audit {

class SwingPhase {
 public:
  explicit SwingPhase(const model::ModelInput& input) : integration_(integration_of(input.scene)) {}
  void state(const std::vector<MovingBody>& bodies);
  double value() const { return value_; }  // of the last state, where it is most; NaN without BDF2, or without such bodies
  void checkpoint(Archive& archive);

 private:
  struct Swing {
    Vec3 v = Vec3::Zero(), a = Vec3::Zero();  // in the last state
    double turned = 0, moved = 0, spun = 0;   // sum a' . v h, sum v . v h, sum w . w v . v h
    double time = 0;                          // of these sums [s]
    double largest = 0;                       // |v|^2 + |a|^2 / omega^2
  };
  Integration integration_;
  std::vector<Swing> swings_;  // by body
  long states_ = 0;
  double value_ = NAN;
};

}  // namespace mortise::audit
