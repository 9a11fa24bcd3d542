#pragma once
// Room for what only the device counts. Who guesses how many there will be, by how many there were last, launches what follows without waiting for
// the number; it comes with others, and where the guess was too small all is done once more.
#include "device/device.h"

namespace mortise::device {

class Room {
 public:
  bool known() const { return among_ > 0; }
  // For those among `n` of what the host does count: as many of them as last time, and an eighth more, as places that stay empty are sorted and gone
  // through too, and a second try costs as much as the first. Contact grows by less from one iterate to the next, as a rule; few are cheap.
  Index among(Index n) const {
    const auto share = static_cast<Index>(known() ? static_cast<double>(last_) / among_ * n : 0.0);
    return share + share / 8 + 16;
  }
  // So many there were among n; and where it was more before, `kept` of that.
  void found(Index there, Index n, double kept = 0) {
    const auto before = static_cast<Index>(known() ? kept * last_ / among_ * n : 0.0);
    last_ = there > before ? there : before, among_ = n;
  }

 private:
  Index last_ = 0, among_ = 0;
};

}  // namespace mortise::device
