#pragma once
// What fields of points are measured in, by their names: for the numbers and the units that users write of them.
#include <string>
#include <vector>

#include "base/param_table.h"

namespace mortise::scene {

struct FieldUnit {
  Unit unit = Unit::any;  // any: nothing is known of such a field; none: it has no units that scenes know, as areas
  std::string symbol;     // in SI; "" where it is not known
};
FieldUnit unit_of_field(const std::string& name);

// What is wrong with `written` as the unit of a field, as the end of a sentence that starts with the key; "" where nothing is.
std::string wrong_unit(const std::string& field, const std::string& written);
std::vector<std::string> units_of_field(const std::string& name);

}  // namespace mortise::scene
