#pragma once
// Reading mesh files that are binary: numbers of either byte order, every complaint with file and offset.
#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <string_view>

#include "base/error.h"

namespace mortise::geometry {

class ByteReader {
 public:
  ByteReader(std::string path, std::string_view bytes, std::size_t begin = 0, std::endian order = std::endian::little)
      : path_(std::move(path)), bytes_(bytes), at_(begin), swap_(order != std::endian::native) {}

  std::size_t left() const { return bytes_.size() - at_; }

  // The next n bytes, as they are.
  std::string_view raw(std::size_t n, const char* what) {
    if (n > left()) fail(std::string("the file ends where ") + what + " is expected");
    at_ += n;
    return bytes_.substr(at_ - n, n);
  }
  template <class T>
  T read(const char* what) {
    char in[sizeof(T)];
    std::memcpy(in, raw(sizeof(T), what).data(), sizeof(T));
    if (swap_) std::reverse(in, in + sizeof(T));
    T value;
    std::memcpy(&value, in, sizeof(T));
    return value;
  }

  [[noreturn]] void fail(const std::string& message) const {
    throw Error(Exit::scene, "'" + path_ + "', byte " + std::to_string(at_) + ": " + message);
  }

 private:
  std::string path_;
  std::string_view bytes_;
  std::size_t at_;
  bool swap_;
};

}  // namespace mortise::geometry
