#include "scene/quantity.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <regex>

#include "scene/suggest.h"

namespace mortise::scene {
namespace {

// SI value = number * factor * 10^power. Powers of ten are added to the exponent of the decimal text, so that "0.3 mm" is the
// same double as 3e-4.
struct Suffix {
  Unit unit;
  const char* text;
  int power;
  double factor;
};
constexpr double kDegree = std::numbers::pi / 180;
constexpr Suffix kSuffixes[] = {
    {Unit::length, "m", 0, 1},
    {Unit::length, "mm", -3, 1},
    {Unit::length, "um", -6, 1},
    {Unit::length, "cm", -2, 1},
    {Unit::length, "km", 3, 1},
    {Unit::length, "nm", -9, 1},
    {Unit::time, "s", 0, 1},
    {Unit::time, "ms", -3, 1},
    {Unit::time, "us", -6, 1},
    {Unit::time, "min", 0, 60},
    {Unit::time, "h", 0, 3600},
    {Unit::mass, "kg", 0, 1},
    {Unit::mass, "g", -3, 1},
    {Unit::mass, "mg", -6, 1},
    {Unit::angle, "rad", 0, 1},
    {Unit::angle, "deg", 0, kDegree},
    {Unit::velocity, "m/s", 0, 1},
    {Unit::velocity, "mm/s", -3, 1},
    {Unit::velocity, "cm/s", -2, 1},
    {Unit::velocity, "um/s", -6, 1},
    {Unit::angular_velocity, "rad/s", 0, 1},
    {Unit::angular_velocity, "deg/s", 0, kDegree},
    {Unit::angular_velocity, "rpm", 0, 6 * kDegree},
    {Unit::acceleration, "m/s^2", 0, 1},
    {Unit::acceleration, "mm/s^2", -3, 1},
    {Unit::force, "N", 0, 1},
    {Unit::force, "mN", -3, 1},
    {Unit::force, "uN", -6, 1},
    {Unit::force, "kN", 3, 1},
    {Unit::pressure, "Pa", 0, 1},
    {Unit::pressure, "kPa", 3, 1},
    {Unit::pressure, "MPa", 6, 1},
    {Unit::pressure, "GPa", 9, 1},
    {Unit::density, "kg/m^3", 0, 1},
    {Unit::density, "g/cm^3", 3, 1},
    {Unit::energy, "J", 0, 1},
    {Unit::energy, "mJ", -3, 1},
    {Unit::energy, "uJ", -6, 1},
    {Unit::energy, "kJ", 3, 1},
    {Unit::energy, "N m", 0, 1},
    {Unit::energy, "N mm", -3, 1},
    {Unit::torque, "N m", 0, 1},
    {Unit::torque, "N mm", -3, 1},
    {Unit::torque, "mN m", -3, 1},
    {Unit::torque, "kN m", 3, 1},
    {Unit::torque, "Nm", 0, 1},
    {Unit::torque, "Nmm", -3, 1},
    {Unit::torque, "mNm", -3, 1},
    {Unit::torque, "J", 0, 1},
    {Unit::torque, "mJ", -3, 1},
    {Unit::stiffness, "N/m", 0, 1},
    {Unit::stiffness, "N/mm", 3, 1},
    {Unit::angular_stiffness, "N m/rad", 0, 1},
    {Unit::angular_stiffness, "Nm/rad", 0, 1},
    {Unit::angular_stiffness, "N m/deg", 0, 1 / kDegree},
    {Unit::damping, "N s/m", 0, 1},
    {Unit::damping, "Ns/m", 0, 1},
    {Unit::angular_damping, "N m s/rad", 0, 1},
    {Unit::angular_damping, "Nms/rad", 0, 1},
    {Unit::rotary_inertia, "kg m^2", 0, 1},
    {Unit::rotary_inertia, "g cm^2", -7, 1},
    {Unit::frequency, "Hz", 0, 1},
    {Unit::frequency, "1/s", 0, 1},
    {Unit::frequency, "kHz", 3, 1},
};

Quantity wrong(std::string error, std::string hint = "") { return {0, std::move(error), std::move(hint)}; }

}  // namespace

const char* dimension(Unit unit) {
  switch (unit) {
    case Unit::none:
      return "pure number";
    case Unit::length:
      return "length";
    case Unit::time:
      return "time";
    case Unit::mass:
      return "mass";
    case Unit::angle:
      return "angle";
    case Unit::velocity:
      return "velocity";
    case Unit::angular_velocity:
      return "angular velocity";
    case Unit::acceleration:
      return "acceleration";
    case Unit::force:
      return "force";
    case Unit::pressure:
      return "pressure";
    case Unit::density:
      return "density";
    case Unit::energy:
      return "energy";
    case Unit::torque:
      return "torque";
    case Unit::stiffness:
      return "stiffness";
    case Unit::angular_stiffness:
      return "stiffness of a hinge";
    case Unit::damping:
      return "damping";
    case Unit::angular_damping:
      return "damping of a hinge";
    case Unit::rotary_inertia:
      return "moment of inertia";
    case Unit::frequency:
      return "frequency";
    case Unit::any:
      return "quantity";
  }
  return "";
}

const char* si_symbol(Unit unit) {
  for (const Suffix& s : kSuffixes)
    if (s.unit == unit) return s.text;  // SI comes first
  return "";
}

std::vector<std::string> suffixes(Unit unit) {
  std::vector<std::string> out;
  for (const Suffix& s : kSuffixes)
    if ((s.unit == unit || unit == Unit::any) && std::find(out.begin(), out.end(), s.text) == out.end()) out.push_back(s.text);
  return out;
}

bool looks_like_quantity(const std::string& text) {
  static const std::regex start(R"(^[-+]?\.?[0-9].*)");
  return std::regex_match(text, start);
}

Quantity parse_quantity(const std::string& text, Unit unit) {
  static const std::regex form(R"(^([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))(?:[eE]([-+]?[0-9]{1,6}))?(?:\s*([^\s0-9.].*))?$)");
  static const std::regex not_finite(R"(^[-+]?\.?(inf|nan|infinity)$)", std::regex::icase);
  static const std::regex octal(R"(^[-+]?0+[0-9].*)");
  std::smatch m;
  if (text.size() > 200) return wrong("is not a number");
  if (std::regex_match(text, not_finite)) return wrong("is '" + text + "'; must be finite");
  if (!std::regex_match(text, m, form)) return wrong("is '" + text + "', which is not a number");
  const std::string digits = m[1], exponent = m[2], suffix = m[3];
  if (std::regex_match(digits, octal))
    return wrong("is '" + text + "': with a leading zero some YAML readers take it as octal", "write it without the leading zero");

  const Suffix* found = nullptr;
  if (!suffix.empty()) {
    // The micro sign may be written as such.
    const std::string plain = std::regex_replace(suffix, std::regex("^(\u00b5|\u03bc)"), "u");
    const Suffix* elsewhere = nullptr;
    for (const Suffix& s : kSuffixes) {
      if (plain != s.text) continue;
      (s.unit == unit || unit == Unit::any ? found : elsewhere) = &s;
    }
    if (!found) {
      const std::vector<std::string> known = suffixes(unit);
      if (unit == Unit::none) return wrong("is '" + text + "'; must be a pure number without unit");
      const std::string allowed = "units of " + std::string(dimension(unit)) + ": " + join(known, ", ");
      if (elsewhere)
        return wrong("is '" + text + "', a " + dimension(elsewhere->unit) + "; must be a" +
                         (unit == Unit::acceleration || unit == Unit::angle || unit == Unit::angular_velocity || unit == Unit::energy ? "n " : " ") +
                         dimension(unit),
                     allowed);
      return wrong("has the unknown unit '" + suffix + "'", unit == Unit::any ? suggestion(suffix, known) : allowed);
    }
  }

  const int power = (exponent.empty() ? 0 : std::stoi(exponent)) + (found ? found->power : 0);
  const std::string decimal = digits + "e" + std::to_string(power);
  double value = 0;
  const char* begin = decimal.c_str() + (decimal[0] == '+');
  const auto [end, code] = std::from_chars(begin, decimal.c_str() + decimal.size(), value);
  // Out of range is either too large or too close to zero; the latter is zero for every purpose here.
  if (code == std::errc::result_out_of_range && power < 0)
    value = 0;
  else if (code != std::errc{} || *end != '\0')
    return wrong("is '" + text + "', which is too large for a number");
  return {value * (found ? found->factor : 1), "", ""};
}

std::string format_number(double v) {
  char buffer[40];
  const auto [end, code] = std::to_chars(buffer, buffer + sizeof buffer, v);
  return code == std::errc{} ? std::string(buffer, end) : "nan";
}

}  // namespace mortise::scene
