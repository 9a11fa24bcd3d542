#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "render/colour_map.h"

namespace mortise::exporters {

// A field that colours the bodies, as pictures do.
struct Colouring {
  std::string field;
  double low = 0, high = 1;                                // at the two ends of the scale, in SI
  render::ColourMap map = render::map_for(0, 1);           // of this range
  std::function<std::vector<double>(std::size_t)> values;  // one or three numbers per point, of the k-th frame

  const std::uint8_t* srgb(double value) const {
    const double share = high > low ? (value - low) / (high - low) : 0;
    return map.data() + 3 * static_cast<std::size_t>(share <= 0 ? 0 : share >= 1 ? 255 : 255 * share + 0.5);
  }
};

// The frames of a run that are exported, in order.
struct Frames {
  std::vector<long> numbers;
  std::vector<double> times;                               // [s]
  std::function<std::vector<double>(std::size_t)> points;  // three coordinates per point [m], of the k-th of these frames
  std::optional<Colouring> colouring;
};

}  // namespace mortise::exporters
