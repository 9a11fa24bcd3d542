#pragma once
// Friction's law is smooth: what sticks creeps, at speeds below `creep_speed`, and what slips more slowly than that has less friction than mu N. With
// the mean speed of the slip over the friction forces, v = P / sum |F|, P what friction takes away [W],
//
//   crept = sum over the steps with v < creep_speed of v dt,
//
// of which a body in a hand slips, or a sheared pad lets go again. Told as a share of the farthest that any point has gone, or of a hundredth of the
// smallest body, whichever is more.
#include <map>
#include <string>

#include "base/archive.h"
#include "base/snapshot.h"
#include "model/input.h"

namespace mortise::run {

class Crept {
 public:
  explicit Crept(const model::ModelInput& input);
  void state(const Snapshot& said);
  void step(double dt);  // that led to that state [s]
  double speed() const;  // what sticks creeps more slowly [m/s]; NaN without friction
  double share() const { return speed_.empty() ? NAN : crept_ / std::fmax(far_, least_); }
  void checkpoint(Archive& archive);

 private:
  std::map<std::string, double> speed_;     // by effect: what sticks creeps more slowly [m/s]
  double least_ = 0, far_ = 0, crept_ = 0;  // [m]
  double now_ = 0;                          // how fast it creeps in the last state, 0 where it slips [m/s]
};

}  // namespace mortise::run
