#pragma once
// What stiff bodies move with that go as the scene says, on pins and kinematic drives, and the work that it takes are no measure of what happens to
// the others: a heavy tray that is driven to and fro hides what a ball on it loses. Of them, with m the mass, v the velocity of the centre x, g
// gravity,
//
//     E = sum 1/2 m v^2 + 1/2 w . I w - m g . x,      per step  W = E - E_before + sum 1/2 m |v - v_before|^2  (backward Euler; w likewise)
//
// are the energy, and the work of what drives them, without contact. With BDF2 that work is told as of the mean of the forces at both ends of a step,
// which where a velocity changes at once, between two keys, is not what it takes: by
//
//     E - E_before - sum 1/2 m (a + a_before) . (x - x_before)      (without gravity; of turning likewise)
//
// energy comes from nowhere then only as far as that sum goes.
#include <cmath>
#include <vector>

#include "audit/moving_body.h"
#include "base/archive.h"

namespace mortise::audit {

class OwnEnergy {
 public:
  explicit OwnEnergy(const model::ModelInput& input);
  void state(const std::vector<MovingBody>& bodies);
  double kinetic() const { return kinetic_; }                // of given bodies [J]
  double raised() const { return weight_ - first_; }         // by that their weights have gone up since the start [J]
  double work() const { return work_; }                      // W of the step that led to the state [J]
  double lost() const { return second_order_ ? 0 : lost_; }  // that part of W which their energy has not [J]
  double untold() const { return untold_; }                  // with BDF2, by that W is more than what is told [J]
  // Energy of the step's change of velocity, of all that a body consists of, taken as rigid [J].
  double change(std::size_t body) const { return changes_[body]; }
  Vec3 fall() const { return fall_; }  // velocity that gravity adds in a step [m/s]
  void checkpoint(Archive& archive);

 private:
  Vec3 gravity_, fall_ = Vec3::Zero();
  // Of a given body in the state before.
  struct Driven {
    double energy = 0, x[3] = {}, force[3] = {}, torque[3] = {};  // m a, and of turning [N, N m]
  };
  bool second_order_;
  double step_ = NAN;  // [s]
  double kinetic_ = 0, weight_ = 0, first_ = NAN, work_ = 0, lost_ = 0, untold_ = 0;
  std::vector<Driven> driven_;
  std::vector<double> moved_;    // v and w of all bodies in the state before
  std::vector<double> changes_;  // by body [J]
};

}  // namespace mortise::audit
