#pragma once
// Reading mesh files that are text: lines, words and numbers, every complaint with file and line.
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/read_file.h"
#include "base/types.h"

namespace mortise::geometry {

// The bytes of a regular file. Throws Exit::file if it cannot be read or has more than `most`.
std::string read_file(const std::string& path, std::uint64_t limit = max_bytes::mesh);

// Lower-case extension with the dot (".obj"), or "".
std::string extension(const std::string& path);

// The whole word as a number; a leading '+' is allowed.
template <class T>
std::optional<T> number_from(std::string_view word) {
  if (!word.empty() && word[0] == '+') word.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

class LineReader {
 public:
  LineReader(std::string path, std::string_view text) : path_(std::move(path)), text_(text) {}

  // Next line that is not blank, split into words; false at the end of the file.
  bool next();
  const std::vector<std::string_view>& words() const { return words_; }
  std::string_view word(std::size_t i, const char* what) const {
    if (i >= words_.size()) fail(std::string("line ends where ") + what + " is expected");
    return words_[i];
  }
  // Finite.
  double number(std::size_t i, const char* what) const {
    const double value = parse<double>(i, what);
    if (!std::isfinite(value)) fail(std::string(what) + " is not a finite number: '" + std::string(words_[i]) + "'");
    return value;
  }
  long long integer(std::size_t i, const char* what) const { return parse<long long>(i, what); }
  Vec3 vec3(std::size_t first, const char* what) const { return {number(first, what), number(first + 1, what), number(first + 2, what)}; }

  // next(), and an error that names `what` if the file is over.
  void require(const char* what);

  int line() const { return line_; }
  std::size_t offset() const { return at_; }  // of the first byte behind this line
  const std::string& path() const { return path_; }
  [[noreturn]] void fail(const std::string& message) const { fail_at(line_, message); }
  [[noreturn]] void fail_at(int line, const std::string& message) const { throw Error(Exit::scene, SourceLoc{path_, line, 1}, message); }

 private:
  template <class T>
  T parse(std::size_t i, const char* what) const {
    const std::string_view w = word(i, what);
    const std::optional<T> value = number_from<T>(w);
    if (!value) fail("expected " + std::string(what) + ", found '" + std::string(w) + "'");
    return *value;
  }

  std::string path_;
  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 0;
  std::vector<std::string_view> words_;
};

}  // namespace mortise::geometry
