#pragma once
#include <string>
#include <vector>

namespace mortise::study {

// A logarithmic axis that holds the values with a little room, and its ticks: decades where there are two or more, else 1, 2, 5 in each.
class Axis {
 public:
  struct Tick {
    double at;          // pixels
    std::string label;  // empty: a line only
  };
  Axis() = default;
  Axis(const std::vector<double>& values, double from_pixel, double to_pixel);
  double at(double value) const;
  std::vector<Tick> ticks() const;

 private:
  double lo_ = 0, hi_ = 1, from_ = 0, to_ = 1;  // lo, hi: decimal logarithms
};

// "0.05", "300"; or "5·10⁻²", "3·10²"
std::string number_label(double mantissa, int decade, bool powers);

}  // namespace mortise::study
