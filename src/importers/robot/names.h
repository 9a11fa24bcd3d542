#pragma once
#include <set>
#include <string>

namespace mortise::importers {

// As names in scenes are: a-z, 0-9, _ and -.
inline std::string scene_name(const std::string& name) {
  std::string out;
  for (const char c : name) {
    const char low = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    const bool fine = (low >= 'a' && low <= 'z') || (low >= '0' && low <= '9') || low == '_' || low == '-';
    out += fine ? low : '_';
  }
  return out.empty() ? "robot" : out;
}

// Each only once: what two share gets a number.
class Names {
 public:
  std::string of(const std::string& name) {
    const std::string base = scene_name(name);
    std::string out = base;
    for (int k = 2; !taken_.insert(out).second; ++k) out = base + "_" + std::to_string(k);
    return out;
  }

 private:
  std::set<std::string> taken_;
};

// With * for any characters and ? for one.
inline bool matches(const char* pattern, const char* text) {
  if (*pattern == '\0') return *text == '\0';
  if (*pattern == '*') return matches(pattern + 1, text) || (*text != '\0' && matches(pattern, text + 1));
  return *text != '\0' && (*pattern == '?' || *pattern == *text) && matches(pattern + 1, text + 1);
}
inline bool matches(const std::string& pattern, const std::string& name) { return matches(pattern.c_str(), name.c_str()); }

}  // namespace mortise::importers
