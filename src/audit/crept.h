#pragma once
// Friction's law is smooth: what begins to stick gives way, and creeps for as long as its contact changes (friction/anchors.h). With P what friction
// takes away where it sticks [W], as its force is below mu N there,
//
//   crept = sum over the steps of P / sum |F| dt,
//
// of which a body in a hand slips, or a sheared pad lets go again. Told as a share of the farthest that any point of the two has gone from where it
// would be if it had gone with one of them, or of a hundredth of the smaller one, whichever is more; of the pair where that is most. How far the two
// went towards each other, or along, while they did not touch is none of it.
#include <cmath>
#include <map>
#include <vector>

#include "audit/friction_pairs.h"
#include "base/archive.h"
#include "base/snapshot.h"
#include "model/input.h"

namespace mortise::audit {

class Crept {
 public:
  explicit Crept(const model::ModelInput& input);
  void state(const Snapshot& said, const std::vector<Rubbing>& rubs);
  void step(double dt);                    // that led to that state [s]
  double speed() const { return speed_; }  // what sticks creeps more slowly [m/s]; NaN without friction
  double share() const;                    // NaN without friction
  void checkpoint(Archive& archive);

 private:
  struct Body {
    std::size_t first = 0, count = 0;  // points
    double size = INFINITY;            // [m]
  };
  struct Pair {
    double crept = 0, far = 0;  // [m]
    double now = 0;             // how fast what sticks gives way in the last state [m/s]
    bool touches = false;
    // What both went on the whole, in the last state in which they touched, and without touching [m].
    Vec3 last[2] = {Vec3::Zero(), Vec3::Zero()}, apart[2] = {Vec3::Zero(), Vec3::Zero()};
  };
  Vec3 gone(std::size_t body, const Snapshot::Values& displacement) const;
  double farthest(const Bodies& bodies, const Pair& pair, const Snapshot::Values& displacement) const;

  double speed_ = NAN;        // creep_speed [m/s]
  std::vector<Body> bodies_;  // that have points; obstacles have later numbers
  std::map<Bodies, Pair> pairs_;
};

}  // namespace mortise::audit
