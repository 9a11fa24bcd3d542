#pragma once
#include <algorithm>
#include <cstddef>

namespace mortise::audit {

// The least of a new value and the last ones, which it is one of from then on: what jumps in one step hardly counts.
template <std::size_t n>
double least_of_last(double (&last)[n], double now) {
  std::rotate(last, last + 1, last + n);
  last[n - 1] = now;
  return *std::min_element(last, last + n);
}

}  // namespace mortise::audit
