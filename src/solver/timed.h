#pragma once
#include <chrono>
#include <string>
#include <string_view>

#include "solver/report.h"

namespace mortise::solver {

// Adds the time until its end to the clock's entry {who, phase}.
class Timed {
 public:
  Timed(Clock& clock, std::string_view who, std::string_view phase) : clock_(clock), key_(who, phase), start_(std::chrono::steady_clock::now()) {}
  ~Timed() {
    auto& [seconds, calls] = clock_.seconds[key_];
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    ++calls;
  }

 private:
  Clock& clock_;
  std::pair<std::string, std::string> key_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace mortise::solver
