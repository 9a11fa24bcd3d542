#pragma once
#include <functional>
#include <vector>

namespace mortise::exporters {

// The frames of a run that are exported, in order.
struct Frames {
  std::vector<long> numbers;
  std::vector<double> times;                               // [s]
  std::function<std::vector<double>(std::size_t)> points;  // three coordinates per point [m], of the k-th of these frames
};

}  // namespace mortise::exporters
