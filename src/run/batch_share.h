#pragma once
#include <algorithm>
#include <string>

namespace mortise::run {

// How the environments of a batch share out the machine: how many of them a model has, and so a process; and how many threads.
class BatchShare {
 public:
  BatchShare() = default;
  // group: environments of a model. gpu: it is not shared, so that one model follows the other.
  BatchShare(long group, int threads, bool gpu) : group_(group), free_(threads), one_at_a_time_(gpu) {}

  long group() const { return group_; }
  bool any_free() const { return free_ > 0; }
  // Threads of the next model, of which `waiting` environments are not there yet: one each while there are enough of them for all threads; the last
  // ones share what is left.
  int take(long waiting) {
    const long models = (waiting + group_ - 1) / group_;
    const int threads = one_at_a_time_ ? free_ : static_cast<int>(std::max<long>(1, free_ / models));
    free_ -= threads;
    return threads;
  }
  void give_back(int threads) { free_ += threads; }
  // Of `count` environments at first.
  std::string text(long count) const {
    const long at_once = one_at_a_time_ ? 1 : std::min<long>(free_, (count + group_ - 1) / group_);
    if (group_ < 2) return std::to_string(at_once) + " at a time";
    return std::to_string(group_) + " in one model, " + std::to_string(at_once) + " model" + (at_once == 1 ? "" : "s") + " at a time";
  }

 private:
  long group_ = 1;
  int free_ = 1;
  bool one_at_a_time_ = false;
};

}  // namespace mortise::run
