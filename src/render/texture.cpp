#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_NO_HDR
#define STBI_NO_LINEAR
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#pragma GCC diagnostic pop

#include "base/error.h"
#include "base/read_file.h"
#include "render/image.h"

namespace mortise::render {
namespace {

constexpr int kMostSide = 16384;               // what OpenGL takes
constexpr long long kMostPixels = 64ll << 20;  // 256 MiB as RGBA

}  // namespace

Texture read_texture(const std::vector<std::uint8_t>& bytes, const std::string& name) {
  Texture t;
  int channels = 0;
  const auto refuse = [&] { throw Error(Exit::scene, "texture " + name + " is not a readable PNG or JPEG: " + stbi_failure_reason()); };
  // Looked at before anything is unpacked: a small file may hold a picture that fills the memory.
  if (stbi_info_from_memory(bytes.data(), static_cast<int>(bytes.size()), &t.width, &t.height, &channels) == 0) refuse();
  if (t.width > kMostSide || t.height > kMostSide || static_cast<long long>(t.width) * t.height > kMostPixels)
    throw Error(Exit::scene, "texture " + name + " has " + std::to_string(t.width) + " x " + std::to_string(t.height) + " pixels; must be at most " +
                                 std::to_string(kMostSide) + " on a side and " + std::to_string(kMostPixels >> 20) + " million in all");
  stbi_uc* pixels = stbi_load_from_memory(bytes.data(), static_cast<int>(bytes.size()), &t.width, &t.height, &channels, 4);
  if (pixels == nullptr) refuse();
  t.rgba.assign(pixels, pixels + static_cast<std::size_t>(t.width) * t.height * 4);
  stbi_image_free(pixels);
  return t;
}

Texture read_texture(const std::string& path) {
  const std::string bytes = read_regular_file(path, max_bytes::texture);
  return read_texture(std::vector<std::uint8_t>(bytes.begin(), bytes.end()), path);
}

}  // namespace mortise::render
