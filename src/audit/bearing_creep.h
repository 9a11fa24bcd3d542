#pragma once
// Dry friction of bearings is smooth as that of contact is (crept.h): what it begins to hold gives way. Of joints without a motor, or with one that
// is told its torque, the sum over the steps with |rate| < the rate from which friction is there in full, of |rate| dt, as a share of the farthest
// that the joint has gone from its start, or of what is no motion that anybody looks at, whichever is more.
#include <string>
#include <vector>

#include "base/archive.h"
#include "base/snapshot.h"
#include "model/input.h"

namespace mortise::audit {

class BearingCreep {
 public:
  explicit BearingCreep(const model::ModelInput& input);
  void state(const Snapshot& said);
  void step(double dt);  // that led to that state [s]
  double share() const;  // of the joint where it is most; NaN without such a bearing
  void checkpoint(Archive& archive);

 private:
  struct Bearing {
    std::string value, rate;                          // what they are reported as
    double speed, least;                              // what is held creeps more slowly [rad/s, m/s]; smallest way that counts [rad, m]
    double start = NAN, far = 0, crept = 0, now = 0;  // [rad, m], [rad/s, m/s]
  };
  std::vector<Bearing> bearings_;
};

}  // namespace mortise::audit
