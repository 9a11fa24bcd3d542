#pragma once
// Bounces: what soft bodies take up where they are struck they give back, and a time step that is not much shorter than that takes a part of it: of a
// contact that lasts n steps of backward Euler a share 1 - exp(-pi^2 / n) of the energy (a linear spring), 10 % for n = 94. Where the body comes to
// rest nobody asks for it; where it flies on, it does so too slowly, by no more than it brought. Of bodies that go as no pin and no motor says, free
// or on joints, together with what hangs on them, and where something soft is struck.
// Joints that reach their stops strike them as stiff bodies do.
// What stiff bodies give back of an impact is in no law here: time step and layer decide it (nearly nothing). Those that fly on from one might do so
// with as much more energy as was lost, or come to rest: what is less of the two, what they fly on with and what was lost, is in doubt.
#include <vector>

#include "base/archive.h"
#include "run/moving_body.h"

namespace mortise::run {

class BounceLoss {
 public:
  // lost: by the step that led to this state, without friction [J].
  void state(const std::vector<MovingBody>& bodies, double lost);
  double sum() const { return sum_; }          // lost in contacts that ended in flight [J]
  double stiff() const { return stiff_; }      // in doubt after impacts of stiff bodies [J]
  double brought() const { return brought_; }  // energy of motion of what struck something in the last step [J]
  void checkpoint(Archive& archive);

 private:
  // Of the contact under way, per body for all that hangs together with it (`MovingBody::group`): steps so far (-1: in flight; no start was seen of
  // what touches in the first state), those of them in which it hardly moved, its energy before [J], lost so far [J]; was something soft struck?
  std::vector<double> steps_, slow_, before_, lost_, soft_;
  double sum_ = 0, stiff_ = 0, brought_ = 0;
};

}  // namespace mortise::run
