#pragma once
// When a run leaves a checkpoint, beside its end.
#include <chrono>

#include "base/params.h"

namespace mortise::run {

class CheckpointTimes {
 public:
  // scene: the whole. seconds: in the place of its `output.checkpoint_every`; 0: that.
  CheckpointTimes(const Params& scene, double seconds) : seconds_(seconds) {
    const Params* every = scene.at("output").find("checkpoint_every");
    if (!every || seconds > 0) return;
    if (const Params* steps = every->find("steps")) steps_ = steps->as_integer();
    if (const Params* given = every->find("seconds")) seconds_ = given->as_number();
  }
  // After a step, with a frame or without.
  bool due(long step, bool frame) const {
    if (steps_ > 0) return step % steps_ == 0;
    if (seconds_ > 0) return std::chrono::duration<double>(Time::now() - saved_).count() >= seconds_;
    return frame;
  }
  void saved() { saved_ = Time::now(); }

 private:
  using Time = std::chrono::steady_clock;
  long steps_ = 0;
  double seconds_;
  Time::time_point saved_ = Time::now();
};

}  // namespace mortise::run
