#pragma once
// Numbers of a scene: "0.5 mm" -> 5e-4, checked against what the number measures.
#include <string>
#include <vector>

#include "base/param_table.h"

namespace mortise::scene {

const char* dimension(Unit);              // "length"
const char* si_symbol(Unit);              // "m"; "" for pure numbers
std::vector<std::string> suffixes(Unit);  // what may stand behind a number, SI first

struct Quantity {
  double value = 0;   // SI
  std::string error;  // empty = fine; else the end of a sentence that starts with the key: "has the unit 'MPa' ..."
  std::string hint;
};
Quantity parse_quantity(const std::string& text, Unit);

bool looks_like_quantity(const std::string& text);  // starts with a number
std::string format_number(double);                  // shortest text that reads back to the same double

}  // namespace mortise::scene
