#pragma once
// The phase of what vibrates with BDF2 (swing_phase.h), of soft bodies: after a time t it is late by
//
//     phi = 1/3 h^2 omega^3 t,     omega^2 = <|v|^2> / <|u - <u>|^2>
//
// with v and u velocities and displacements of its points, by mass, and < > means over the states so far: of many modes those that go far count,
// which is what displacements show. Of soft bodies that nothing moves (no pin that goes, no joint, bond or tie, no load of their own) until they
// touch something, once they have swung for a period. Told in terms of the largest swing so far, of which |v|^2 + omega^2 |u - <u>|^2 tells how much
// is left.
#include <vector>

#include "audit/moving_body.h"
#include "base/archive.h"
#include "base/snapshot.h"
#include "model/input.h"

namespace mortise::audit {

class SoftPhase {
 public:
  explicit SoftPhase(const model::ModelInput& input);
  void state(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies);
  double value() const { return value_; }  // of the last state, where it is most; NaN without BDF2, or without such bodies
  void checkpoint(Archive& archive);

 private:
  struct Swing {
    double alone = 0;     // nothing moves it, nothing has touched it
    double v = 0, u = 0;  // sums over the states of |v|^2 and |u|^2
    double largest = 0;   // |v|^2 + omega^2 |u - <u>|^2
  };
  Integration integration_;
  std::vector<Swing> swings_;  // by body
  std::vector<double> sum_;    // of the displacements of all points
  double states_ = 0;
  double value_ = NAN;
};

}  // namespace mortise::audit
