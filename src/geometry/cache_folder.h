#pragma once
#include <filesystem>

namespace mortise::geometry {

// Where results that take long are kept: MORTISE_CACHE, or mortise in XDG_CACHE_HOME or ~/.cache. Empty: nowhere.
std::filesystem::path cache_folder();

}  // namespace mortise::geometry
