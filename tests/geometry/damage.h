#pragma once
// Damaged copies of a file, for tests of readers: whatever the bytes, a reader returns or throws Error.
#include <functional>
#include <string>

#include "base/error.h"

namespace mortise::geometry {

// The first bytes of a file, in every length: how many of them were accepted.
inline std::size_t accepted_beginnings(const std::string& file, const std::function<void(const std::string&)>& read) {
  std::size_t accepted = 0;
  for (std::size_t n = 0; n < file.size(); ++n) try {
      read(file.substr(0, n));
      ++accepted;
    } catch (const Error&) {
    }
  return accepted;
}

// Every byte in turn replaced: how many copies were refused.
inline std::size_t refused_changes(const std::string& file, const std::function<void(const std::string&)>& read) {
  std::size_t refused = 0;
  for (std::size_t i = 0; i < file.size(); ++i)
    for (const char byte : {'\0', '\1', '\x7f', '\x80', '\xff', '9', ' ', '\n'}) try {
        std::string copy = file;
        copy[i] = byte;
        read(copy);
      } catch (const Error&) {
        ++refused;
      }
  return refused;
}

}  // namespace mortise::geometry
