#pragma once
// How an entry of the list `pin` moves what it holds: rotations one after the other, then a turn by quaternions, then a translation, through keys.
#include <vector>

#include "base/params.h"
#include "effects/pin/orientation.h"
#include "effects/pin/pin.h"

namespace mortise::effects::pin {

class Motion {
 public:
  explicit Motion(const Params& pin);  // throws Error(Exit::scene)

  bool moves() const { return moves_; }
  bool turns() const { return !turns_.empty() || orientation_.any(); }
  bool same_as(const Motion& other) const;
  RigidMotion at(double t) const;

 private:
  Schedule schedule(const Params& time, const Params& value) const;
  static Schedule still() { return Schedule(Params::make_number(0)); }
  struct Turn {
    Vec3 axis, centre;
    Schedule angle;
  };

  bool moves_ = false, smooth_ = false;
  Params params_;
  Schedule translation_[3] = {still(), still(), still()};
  std::vector<Turn> turns_;
  Orientation orientation_;
};

}  // namespace mortise::effects::pin
