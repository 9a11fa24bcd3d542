#pragma once
#include <string>

namespace mortise::model {

// What somebody outside asks of a joint's drive, in place of the scene's target: `from` at the time `begin`, on a straight line to `to` at `end` [s],
// and that from then on. In rad, m, N m or N.
struct Command {
  std::string joint;
  double from = 0, to = 0, begin = 0, end = 0;
  double at(double t) const {
    constexpr double kThere = 1 - 1e-9;  // times are sums of steps, rounded
    const double fraction = end > begin ? (t - begin) / (end - begin) : 1;
    return fraction >= kThere ? to : fraction <= 0 ? from : from + fraction * (to - from);
  }
};

}  // namespace mortise::model
