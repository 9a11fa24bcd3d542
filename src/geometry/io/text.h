#pragma once
// Reading mesh files that are text: lines, words and numbers, every complaint with file and line.
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/types.h"

namespace mortise::geometry {

// The bytes of a file. Throws Exit::file if it cannot be read.
std::string read_file(const std::string& path);

// Lower-case extension with the dot (".obj"), or "".
std::string extension(const std::string& path);

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
  double number(std::size_t i, const char* what) const { return parse<double>(i, what); }
  long long integer(std::size_t i, const char* what) const { return parse<long long>(i, what); }
  Vec3 vec3(std::size_t first, const char* what) const {
    return {number(first, what), number(first + 1, what), number(first + 2, what)};
  }

  // next(), and an error that names `what` if the file is over.
  void require(const char* what);

  int line() const { return line_; }
  const std::string& path() const { return path_; }
  [[noreturn]] void fail(const std::string& message) const { fail_at(line_, message); }
  [[noreturn]] void fail_at(int line, const std::string& message) const {
    throw Error(Exit::scene, SourceLoc{path_, line, 1}, message);
  }

 private:
  template <class T>
  T parse(std::size_t i, const char* what) const {
    std::string_view w = word(i, what);
    const std::string_view shown = w;
    if (!w.empty() && w[0] == '+') w.remove_prefix(1);
    T value{};
    const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), value);
    if (error != std::errc() || end != w.data() + w.size())
      fail("expected " + std::string(what) + ", found '" + std::string(shown) + "'");
    return value;
  }

  std::string path_;
  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 0;
  std::vector<std::string_view> words_;
};

}  // namespace mortise::geometry
