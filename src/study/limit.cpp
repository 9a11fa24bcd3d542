#include "study/limit.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "scene/quantity.h"

namespace mortise::study {
namespace {

// A number with a unit of whatever dimension, in SI; NaN if it is none. `dimension`: what it measures.
double read_number(const std::string& text, Unit& dimension) {
  for (Unit unit : {Unit::none, Unit::length, Unit::time, Unit::pressure, Unit::force, Unit::angle, Unit::velocity}) {
    const scene::Quantity q = scene::parse_quantity(text, unit);
    if (!q.error.empty()) continue;
    dimension = unit;
    return q.value;
  }
  return NAN;
}

}  // namespace

std::vector<double> ladder_sizes(const std::vector<std::string>& settings) {
  std::vector<double> sizes;
  Unit first = Unit::none, unit = Unit::none;
  for (const std::string& s : settings) {
    const double v = read_number(s, unit);
    if (sizes.empty()) first = unit;
    if (!(v > 0) || unit != first) return {};
    sizes.push_back(v);
  }
  if (sizes.size() > 1 && sizes[1] > sizes[0])
    for (double& h : sizes) h = 1 / h;
  for (std::size_t i = 1; i < sizes.size(); ++i)
    if (!(sizes[i] < sizes[i - 1])) return {};
  return sizes;
}

Limit limit_of(const std::vector<double>& sizes, const std::vector<double>& values) {
  constexpr double kLeast = 0.5, kMost = 5;  // orders that a method has; others are chance
  const std::size_t n = values.size();
  const auto finest = [&](const char* why) { return Limit{values.back(), false, fmt::format("the finest run: {}", why)}; };
  if (n < 3) return finest("a limit needs three");
  if (sizes.size() != n) return finest("no sizes are known that fall along the ladder");
  const double h1 = sizes[n - 3], h2 = sizes[n - 2], h3 = sizes[n - 1];
  const double far = values[n - 3] - values[n - 2], near = values[n - 2] - values[n - 1];
  if (!(near * far > 0)) return finest("differences change sign, no limit is in sight");
  // Of p the right-hand side rises from log(h1/h2)/log(h2/h3) at p = 0 on.
  const auto excess = [&](double p) { return (std::pow(h1, p) - std::pow(h2, p)) / (std::pow(h2, p) - std::pow(h3, p)) - far / near; };
  if (!(excess(kLeast) <= 0 && excess(kMost) >= 0)) return finest("differences do not fall as those of a converging ladder do");
  double lo = kLeast, hi = kMost;
  for (int i = 0; i < 80; ++i) {
    const double p = 0.5 * (lo + hi);
    (excess(p) < 0 ? lo : hi) = p;
  }
  const double p = 0.5 * (lo + hi);
  const double limit = values[n - 1] - near * std::pow(h3, p) / (std::pow(h2, p) - std::pow(h3, p));
  return {limit, true, fmt::format("extrapolated at an observed order of {:.2g}", p)};
}

}  // namespace mortise::study
