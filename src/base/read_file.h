#pragma once
#include <cstdint>
#include <string>

namespace mortise {

// Limits of what is read at a stretch [bytes]: beyond them a file is taken for a mistake or an attack, not for input.
namespace max_bytes {
inline constexpr std::uint64_t scene = std::uint64_t{64} << 20;
inline constexpr std::uint64_t mesh = std::uint64_t{8} << 30;
inline constexpr std::uint64_t materials = std::uint64_t{16} << 20;  // .mtl
inline constexpr std::uint64_t texture = std::uint64_t{256} << 20;
inline constexpr std::uint64_t results = std::uint64_t{256} << 30;  // what we wrote ourselves
}  // namespace max_bytes

// Whole content of a regular file: pipes would wait for ever, devices have no end. Throws Error(Exit::file) with path and reason, also where
// reading ends before the file does.
std::string read_regular_file(const std::string& path, std::uint64_t limit);

// Where text begins: behind the mark of byte order with which some programs begin UTF-8.
inline std::size_t after_mark(const std::string& text) { return text.starts_with("\xEF\xBB\xBF") ? 3 : 0; }

// A stream without a known length ("-" = standard input, or the path of a pipe), up to `most` bytes.
std::string read_stream(const std::string& path, std::uint64_t limit);

}  // namespace mortise
