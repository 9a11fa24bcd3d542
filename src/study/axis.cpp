#include "study/axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mortise::study {

static constexpr double kPlain = 3;  // decades of numbers that are written out

Axis::Axis(const std::vector<double>& values, double from_pixel, double to_pixel) : from_(from_pixel), to_(to_pixel) {
  if (values.empty()) return;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  lo_ = std::log10(*least), hi_ = std::log10(*most);
  const double room = std::max(0.08 * (hi_ - lo_), 0.12);
  lo_ -= room, hi_ += room;
}

double Axis::at(double value) const { return from_ + (to_ - from_) * (std::log10(value) - lo_) / (hi_ - lo_); }

std::string number_label(double mantissa, int decade, bool powers) {
  if (!powers || decade == 0 || decade == 1) return fmt::format("{:g}", mantissa * std::pow(10.0, decade));
  static const char* const kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string power;
  for (char c : std::to_string(decade)) power += c == '-' ? "⁻" : kDigits[c - '0'];
  return (mantissa == 1 ? "" : fmt::format("{:g}·", mantissa)) + "10" + power;
}

std::vector<Axis::Tick> Axis::ticks() const {
  std::vector<Tick> out;
  const double decades = hi_ - lo_;
  const int every = std::max(1, static_cast<int>(std::ceil(decades / 7)));
  const bool powers = lo_ < -kPlain || hi_ > kPlain + 1;  // of all labels or of none
  for (int d = static_cast<int>(std::floor(lo_)); d <= static_cast<int>(std::ceil(hi_)); ++d)
    for (int m = 1; m < 10; ++m) {
      const double log = d + std::log10(m);
      if (log < lo_ || log > hi_ || (m > 1 && decades > 5)) continue;
      const bool labelled = m == 1 ? d % every == 0 : decades < 0.6 || (decades < 2 && (m == 2 || m == 5));
      out.push_back({from_ + (to_ - from_) * (log - lo_) / (hi_ - lo_), labelled ? number_label(m, d, powers) : ""});
    }
  return out;
}

}  // namespace mortise::study
