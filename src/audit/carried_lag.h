#pragma once
// What is carried about (a box put on a conveyor, a jaw on a hand that moves) has a way along what carries it, which may be small beside the way of
// that and is what somebody looks at: as seen from there it lags as any other does (lagging_ways.h). Carriers are the body that goes as the scene
// says at the end of a chain of joints and, of what is free, the body that presses it most: along that it slides; what jaws hold from two sides goes
// along with what carries those. Not counted are those that turn, as directions turn with them, and those that go less far, since the way as seen
// from the world tells as much then. Where the speed of a carrier jumps, as between two keys, a new way begins; where its acceleration does, slip
// sets in (slip_onset.h).
#include <vector>

#include "audit/lagging_ways.h"
#include "audit/moving_body.h"
#include "audit/slip_onset.h"

namespace mortise::audit {

class CarriedLag {
 public:
  void start(const MovingBody& body, const std::vector<double>& points);  // one after the other
  // Of a body that nothing leads, after so many steps of length h [s].
  double lag(std::size_t body, const std::vector<MovingBody>& bodies, double h, long steps);
  void checkpoint(Archive& archive);

 private:
  // Of a body: what carries it (its number, or -1), for how many steps; the lag; ways of that, at the body, and of the body along it since then [m].
  // Also its velocity along that and the carrier's there in the last state, and what the latter changed by to that and to the one before [m/s]; and
  // the farthest that it should have gone along it [m].
  struct Carried {
    double by = -1, steps = 0, lag = 0, far = 0;
    double carrier[3] = {0, 0, 0}, along[3] = {0, 0, 0};
    double v[3] = {0, 0, 0}, before[3] = {0, 0, 0}, there[3] = {0, 0, 0}, changed[3] = {0, 0, 0}, changed_before = 0;
    SlipOnset onset = SlipOnset(false);
  };
  double hardly(std::size_t body, double h) const;  // less is no speed of a carrier [m/s]
  void set_off(std::size_t body, Carried& c, const Vec3& changed, double h);
  std::vector<Carried> carried_;  // by body
  LaggingWays ways_;
};

}  // namespace mortise::audit
