#include "geometry/cache_folder.h"

#include <cstdlib>

namespace mortise::geometry {

std::filesystem::path cache_folder() {
  if (const char* own = std::getenv("MORTISE_CACHE")) return own;
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg && *xdg) return std::filesystem::path(xdg) / "mortise";
  if (const char* home = std::getenv("HOME"); home && *home) return std::filesystem::path(home) / ".cache" / "mortise";
  return {};
}

}  // namespace mortise::geometry
