#pragma once
// Cells of tables in text files.
#include <fmt/format.h>

#include <cmath>
#include <string>

namespace mortise {

// In quotes where it has to be.
inline std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

// Nothing where it is no number.
inline std::string csv_cell(double v) { return std::isfinite(v) ? fmt::format("{}", v) : ""; }

}  // namespace mortise
