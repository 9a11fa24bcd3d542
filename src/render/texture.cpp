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

#include <fstream>
#include <iterator>

#include "base/error.h"
#include "render/image.h"

namespace mortise::render {

Texture read_texture(const std::vector<std::uint8_t>& bytes, const std::string& name) {
  Texture t;
  int channels = 0;
  stbi_uc* pixels =
      stbi_load_from_memory(bytes.data(), static_cast<int>(bytes.size()), &t.width, &t.height, &channels, 4);
  if (pixels == nullptr) throw Error(Exit::scene, "texture " + name + " is not a readable PNG or JPEG: " + stbi_failure_reason());
  t.rgba.assign(pixels, pixels + static_cast<std::size_t>(t.width) * t.height * 4);
  stbi_image_free(pixels);
  return t;
}

Texture read_texture(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error(Exit::scene, "cannot open the texture " + path);
  return read_texture({std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()}, path);
}

}  // namespace mortise::render
