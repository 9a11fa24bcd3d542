#pragma once
// The container: one JSON object and one buffer (Khronos, glTF 2.0, section 4).
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "base/types.h"

namespace mortise::exporters {

class Glb {
 public:
  using Json = nlohmann::ordered_json;

  // The object; its arrays of buffers, views and accessors are made by the functions below.
  Json json = {{"asset", {{"version", "2.0"}}}};

  // Each appends to the buffer and returns the index of its accessor.
  int vectors(std::span<const Vec3> values);         // with the bounds that positions need
  int uvs(std::span<const Vec2> values);             // (0, 0) lower left, as render has them; glTF's is upper left
  int colours(std::span<const std::uint16_t> rgba);  // linear, 65535 is one
  int indices(std::span<const std::uint32_t> values);
  int numbers(std::span<const float> values, const char* type = "SCALAR");  // of VEC4 four each

  int image(std::span<const std::uint8_t> png);  // index of a texture

  // Throws Error(Exit::file), also where the file would be larger than the format's 4 GiB.
  void write(const std::string& path) const;

 private:
  int view(const void* data, std::size_t bytes, int target);
  int accessor(int view, int component, std::size_t count, const char* type);
  std::string buffer_;
};

}  // namespace mortise::exporters
