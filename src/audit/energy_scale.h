#pragma once
// What losses of energy are held against: the largest energy of a run, and how much supports put in, there and back.
#include <algorithm>
#include <cmath>
#include <string>

#include "base/archive.h"

namespace mortise::audit {

class EnergyScale {
 public:
  void holds(double energy) { largest_ = std::max(largest_, energy); }
  // counts: the work is all that is done, so that its sum is energy.
  void worked(double work, bool counts) {
    there_and_back_ += std::abs(work);
    if (counts) work_ += work, holds(std::abs(work_));
  }
  double largest() const { return largest_; }
  double work() const { return work_; }
  double turnover() const { return std::max(largest_, there_and_back_); }
  void checkpoint(Archive& archive, const std::string& name) {
    for (auto [what, value] : {std::pair{".largest", &largest_}, {".work", &work_}, {".there_and_back", &there_and_back_}})
      archive.io(name + what, *value);
  }

 private:
  double largest_ = 0, work_ = 0, there_and_back_ = 0;  // [J]
};

}  // namespace mortise::audit
