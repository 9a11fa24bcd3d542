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
  void moves(double energy) { moved_ = std::max(moved_, energy); }  // energy of motion
  // counts: the work is all that is done, so that its sum is energy.
  void worked(double work, bool counts) {
    there_and_back_ += std::abs(work);
    if (counts) work_ += work, holds(std::abs(work_));
  }
  // steady: of the energy of motion, what does not count.
  double largest(double steady = 0) const { return std::max(largest_, moved_ - steady); }
  double work() const { return work_; }
  double turnover(double steady = 0) const { return std::max(largest(steady), there_and_back_); }
  void checkpoint(Archive& archive, const std::string& name) {
    for (auto [what, value] : {std::pair{".largest", &largest_}, {".moved", &moved_}, {".work", &work_}, {".there_and_back", &there_and_back_}})
      archive.io(name + what, *value);
  }

 private:
  double largest_ = 0, moved_ = 0, work_ = 0, there_and_back_ = 0;  // [J]
};

}  // namespace mortise::audit
