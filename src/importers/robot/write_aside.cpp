#include "importers/robot/write_aside.h"

#include <unistd.h>

#include <filesystem>

#include "base/error.h"
#include "geometry/io/write.h"

namespace mortise::importers {

namespace fs = std::filesystem;

std::string write_aside(const std::string& file, std::string_view bytes) {
  const std::string aside = file + "." + std::to_string(::getpid()) + ".tmp";
  geometry::write_file(aside, bytes);
  std::error_code error;
  fs::rename(aside, file, error);
  if (error) throw Error(Exit::file, "cannot write '" + file + "': " + error.message());
  return fs::absolute(file).lexically_normal().string();
}

}  // namespace mortise::importers
