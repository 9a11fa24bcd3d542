#include "linalg/env_sums.h"

#include <algorithm>

namespace mortise::linalg {

EnvSums::EnvSums(const std::vector<Index>& offset) {
  std::vector<Index> below = offset;
  for (bool more = true; more;) {
    std::vector<Index> start, first{0};
    more = false;
    for (std::size_t e = 0; e + 1 < below.size(); ++e) {
      const Index n = below[e + 1] - below[e];
      const Index chunks = std::max<Index>(1, (n + device::kChunk - 1) / device::kChunk);  // an empty environment sums to zero
      for (Index c = 0; c < chunks; ++c) start.push_back(below[e] + c * device::kChunk);
      first.push_back(static_cast<Index>(start.size()));
      more = more || chunks > 1;
    }
    start.push_back(below.back());
    value_.emplace_back(first.back());
    start_.emplace_back(start);
    below = first;
  }
}

}  // namespace mortise::linalg
