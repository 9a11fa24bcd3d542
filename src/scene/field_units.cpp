#include "scene/field_units.h"

#include "scene/quantity.h"

namespace mortise::scene {

FieldUnit unit_of_field(const std::string& name) {
  const auto known = [](Unit unit) { return FieldUnit{unit, si_symbol(unit)}; };
  if (name == "displacement") return known(Unit::length);
  if (name == "velocity") return known(Unit::velocity);
  if (name.ends_with("_force")) return known(Unit::force);
  if (name.ends_with("_pressure")) return known(Unit::pressure);
  if (name.ends_with("_area")) return {Unit::none, "m^2"};
  return {};
}

std::vector<std::string> units_of_field(const std::string& name) {
  const FieldUnit f = unit_of_field(name);
  return f.unit == Unit::none ? std::vector<std::string>{f.symbol} : suffixes(f.unit);
}

std::string wrong_unit(const std::string& field, const std::string& written) {
  const FieldUnit f = unit_of_field(field);
  if (written == f.symbol || (f.unit != Unit::none && parse_quantity("1 " + written, f.unit).error.empty())) return "";
  if (!parse_quantity("1 " + written, Unit::any).error.empty()) return "is '" + written + "', which is no unit";
  return "is '" + written + "', which is no unit of " + (f.unit == Unit::none ? "'" + field + "'" : dimension(f.unit));
}

}  // namespace mortise::scene
