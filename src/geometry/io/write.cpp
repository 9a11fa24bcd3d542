#include "geometry/io/write.h"

#include <charconv>
#include <fstream>

#include "base/error.h"

namespace mortise::geometry {

void append_numbers(std::string& out, const double* values, int n) {
  char buffer[32];
  for (int k = 0; k < n; ++k) {
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, values[k]).ptr;
    out += ' ';
    out.append(buffer, end);
  }
  out += '\n';
}

void write_file(const std::string& path, std::string_view bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw Error(Exit::file, "cannot write '" + path + "'");
}

}  // namespace mortise::geometry
