#pragma once
// When a run leaves a checkpoint, beside its end: as its scene says, or else with its frames, as long as that takes it a small share of its time.
#include <chrono>

#include "base/params.h"
#include "run/tuning.h"

namespace mortise::run {

class CheckpointTimes {
 public:
  // scene: the whole. seconds: in the place of its `output.checkpoint_every`; 0 and below: that. runs: that save their states in turn, this one among
  // them.
  CheckpointTimes(const Params& scene, double seconds, long runs) : seconds_(seconds), runs_(static_cast<double>(runs)) {
    const Params* every = scene.at("output").find("checkpoint_every");
    if (!every || seconds > 0) return;
    if (const Params* steps = every->find("steps")) steps_ = steps->as_integer();
    if (const Params* given = every->find("seconds")) seconds_ = given->as_number();
  }
  // After a step, with a frame or without.
  bool due(long step, bool frame) const {
    if (steps_ > 0) return step % steps_ == 0;
    const double since = std::chrono::duration<double>(Time::now() - saved_).count();
    if (seconds_ > 0) return since >= seconds_;
    return frame && since >= runs_ * took_ / tuning::kSaving;
  }
  // One is there, which took so long [s].
  void saved(double took) { saved_ = Time::now(), took_ = took; }

 private:
  using Time = std::chrono::steady_clock;
  long steps_ = 0;
  double seconds_, runs_, took_ = 0;
  Time::time_point saved_ = Time::now();
};

}  // namespace mortise::run
