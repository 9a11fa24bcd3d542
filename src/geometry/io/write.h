#pragma once
#include <string>
#include <string_view>

namespace mortise::geometry {

// Appends the numbers, each behind a blank, and a line end, with the fewest digits that read back to the same doubles.
void append_numbers(std::string& out, const double* values, int n);

// Throws Exit::file if the file cannot be written completely.
void write_file(const std::string& path, std::string_view bytes);

}  // namespace mortise::geometry
