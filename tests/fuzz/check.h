#pragma once
#include <cstdlib>

#include "base/types.h"

namespace mortise {

// Ends the program, which libFuzzer reports, when an element names a point that is not there.
template <class Elements>
void within(const Elements& elements, std::size_t points) {
  for (const auto& e : elements)
    for (Index v : e.v)
      if (v < 0 || static_cast<std::size_t>(v) >= points) std::abort();
}

}  // namespace mortise
