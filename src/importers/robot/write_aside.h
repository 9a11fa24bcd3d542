#pragma once
#include <string>
#include <string_view>

namespace mortise::importers {

// A file that is whole, or is not there: another process may read the same cache. Its absolute path. Throws Error(Exit::file).
std::string write_aside(const std::string& file, std::string_view bytes);

}  // namespace mortise::importers
