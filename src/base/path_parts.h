#pragma once
#include <string>
#include <vector>

namespace mortise {

// "a.b.0" in its parts.
inline std::vector<std::string> path_parts(const std::string& path) {
  std::vector<std::string> parts{""};
  for (const char c : path) {
    if (c == '.')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

}  // namespace mortise
