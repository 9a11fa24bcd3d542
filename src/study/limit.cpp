#include "study/limit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/quantity.h"
#include "study/tuning.h"

namespace mortise::study {
namespace {

// `dimension`: what it measures.
double read_number(const std::string& text, Unit& dimension) {
  for (Unit unit : {Unit::none, Unit::length, Unit::time, Unit::mass, Unit::pressure, Unit::force, Unit::angle, Unit::velocity,
                    Unit::angular_velocity, Unit::acceleration, Unit::density, Unit::energy, Unit::torque, Unit::stiffness, Unit::angular_stiffness,
                    Unit::damping, Unit::angular_damping, Unit::rotary_inertia, Unit::frequency}) {
    const scene::Quantity q = scene::parse_quantity(text, unit);
    if (!q.error.empty()) continue;
    dimension = unit;
    return q.value;
  }
  return NAN;
}

// Numbers of one unit; empty where they are not.
std::vector<double> numbers(const std::vector<std::string>& settings, Unit& unit) {
  std::vector<double> out;
  Unit first = Unit::none;
  for (const std::string& s : settings) {
    const double v = read_number(s, unit);
    if (out.empty()) first = unit;
    if (!std::isfinite(v) || unit != first) return {};
    out.push_back(v);
  }
  return out;
}

bool falls(const std::vector<double>& v) {
  return std::adjacent_find(v.begin(), v.end(), [](double a, double b) { return !(b < a); }) == v.end();
}

// From the three values that end at `last`; not extrapolated where they have no limit, with the reason.
Limit richardson(const std::vector<double>& h, const std::vector<double>& q, std::size_t last) {
  const double h1 = h[last - 2], h2 = h[last - 1], h3 = h[last], far = q[last - 2] - q[last - 1], near = q[last - 1] - q[last];
  Limit out{q[last], false, 0, tuning::kUnknownOrder * std::abs(near), ""};
  if (far == 0 && near == 0) return {q[last], false, 0, 0, "the finest run: the last three are equal"};
  if (!(near * far > 0)) {  // it may have come near by chance, and go off as far again
    out.uncertainty = std::max(out.uncertainty, std::abs(far));
    return out.how = "the finest run: differences change sign, no limit is in sight", out;
  }
  // Of p the right-hand side rises from log(h1/h2)/log(h2/h3) at p = 0 on.
  const auto excess = [&](double p) { return (std::pow(h1, p) - std::pow(h2, p)) / (std::pow(h2, p) - std::pow(h3, p)) - far / near; };
  double lo = tuning::kLeastOrder, hi = tuning::kMostOrder;
  if (!(excess(lo) <= 0 && excess(hi) >= 0)) return out.how = "the finest run: differences do not fall as those of a converging ladder do", out;
  for (int i = 0; i < 80; ++i) {
    const double p = 0.5 * (lo + hi);
    (excess(p) < 0 ? lo : hi) = p;
  }
  out.order = 0.5 * (lo + hi), out.extrapolated = true;
  const double p = out.order, step = near * std::pow(h3, p) / (std::pow(h2, p) - std::pow(h3, p));
  out.value = q[last] - step, out.uncertainty = tuning::kSafety * std::abs(step);
  out.how = fmt::format("extrapolated at an observed order of {:.2g}", p);
  return out;
}

// Of a ladder whose last differences are small by chance, as they fell faster than those of any method do: the last one that they cannot have come
// from.
double jumped(const std::vector<double>& h, const std::vector<double>& q) {
  double out = 0;
  for (std::size_t i = q.size() - 1; i > 1; --i) {
    const double far = q[i - 2] - q[i - 1], near = q[i - 1] - q[i], p = tuning::kMostOrder;
    const double fastest = (std::pow(h[i - 2], p) - std::pow(h[i - 1], p)) / (std::pow(h[i - 1], p) - std::pow(h[i], p));
    if (!(std::abs(far) > fastest * std::abs(near))) break;
    out = std::abs(far);
  }
  return out;
}

}  // namespace

double any_number(const std::string& text) {
  Unit unit = Unit::none;
  return read_number(text, unit);
}

std::vector<double> ladder_sizes(const std::vector<std::string>& settings) {
  Unit unit = Unit::none;
  std::vector<double> sizes = numbers(settings, unit);
  if (std::any_of(sizes.begin(), sizes.end(), [](double v) { return !(v > 0); })) return {};
  if (sizes.size() > 1 && sizes[1] > sizes[0])
    for (double& h : sizes) h = 1 / h;
  return falls(sizes) ? sizes : std::vector<double>{};
}

std::string not_a_ladder(const std::vector<std::string>& settings) {
  Unit unit = Unit::none;
  const std::vector<double> v = numbers(settings, unit);
  if (v.size() < 2) return "";
  if (falls(v)) return "";
  for (std::size_t i = 1; i < v.size(); ++i)
    if (v[i] == v[i - 1]) return "a value stands in it twice; a ladder goes from coarse to fine";
  if (!falls({v.rbegin(), v.rend()})) return "its values go up and down; a ladder goes from coarse to fine";
  if (unit == Unit::length || unit == Unit::time) return "its values grow; a ladder goes from coarse to fine, the largest length or time first";
  return "";
}

Limit limit_of(const std::vector<double>& sizes, const std::vector<double>& values) {
  const std::size_t n = values.size();
  if (n == 0) return {NAN, false, 0, NAN, "no run"};
  const double near = n > 1 ? std::abs(values[n - 1] - values[n - 2]) : NAN;
  const Limit finest{values.back(), false, 0, tuning::kUnknownOrder * near, ""};
  const auto because = [&](const char* why) {
    Limit out = finest;
    out.how = fmt::format("the finest run: {}", why);
    return out;
  };
  if (n < 3) return because("a limit needs three");
  if (sizes.size() != n) return because("no sizes are known that fall along the ladder");
  Limit limit = richardson(sizes, values, n - 1);
  if (!limit.extrapolated) limit.uncertainty = std::max(limit.uncertainty, jumped(sizes, values));
  if (!limit.extrapolated || n < 4) return limit;
  const Limit before = richardson(sizes, values, n - 2);
  if (!before.extrapolated) return limit;
  const double step = std::abs(limit.value - values.back());
  limit.uncertainty = std::min(limit.uncertainty, std::max(tuning::kSafety * std::abs(limit.value - before.value), tuning::kLeastShare * step));
  return limit;
}

}  // namespace mortise::study
