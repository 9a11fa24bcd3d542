#pragma once
#include <cmath>

#include "base/snapshot.h"

namespace mortise::audit {

// What progress lines and step tables show beside the solver's own figures; NaN where no effect reported it.
struct ContactFigures {
  double pairs = NAN;    // active contact pairs
  double min_gap = NAN;  // [m]
};

// Any contact effect reports these two; several add up.
inline ContactFigures contact_figures(const Snapshot& said) {
  ContactFigures out;
  for (const auto& [name, value] : said.number) {
    if (leaf_of(name) == "active_pairs") out.pairs = std::isfinite(out.pairs) ? out.pairs + value : value;
    if (leaf_of(name) == "min_distance") out.min_gap = std::fmin(out.min_gap, value);
  }
  return out;
}

}  // namespace mortise::audit
