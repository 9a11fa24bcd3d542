#include "geometry/io/text.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace mortise::geometry {

std::string read_file(const std::string& path, std::uint64_t limit) { return read_regular_file(path, limit); }

std::string extension(const std::string& path) {
  std::string e = std::filesystem::path(path).extension().string();
  std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return std::tolower(c); });
  return e;
}

bool LineReader::next() {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (at_ < text_.size()) {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    const std::string_view line = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    ++line_;
    words_.clear();
    for (std::size_t i = 0; i < line.size();) {
      while (i < line.size() && blank(line[i])) ++i;
      std::size_t j = i;
      while (j < line.size() && !blank(line[j])) ++j;
      if (j > i) words_.push_back(line.substr(i, j - i));
      i = j;
    }
    if (!words_.empty()) return true;
  }
  words_.clear();
  return false;
}

void LineReader::require(const char* what) {
  if (!next()) fail(std::string("the file ends where ") + what + " is expected");
}

}  // namespace mortise::geometry
