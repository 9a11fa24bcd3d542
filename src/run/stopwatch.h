#pragma once
#include <chrono>

#include "base/cpu_time.h"

namespace mortise::run {

// Time since it was made.
class Stopwatch {
 public:
  double wall() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count(); }
  double cpu() const { return cpu_time() - cpu_; }

 private:
  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
  double cpu_ = cpu_time();
};

}  // namespace mortise::run
