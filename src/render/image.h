#pragma once
// Pictures in memory and on disk.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace mortise::render {

// sRGB, 8 bits a channel, first row on top.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // height x width x 3

  const std::uint8_t* at(int x, int y) const { return rgb.data() + 3 * (static_cast<std::size_t>(y) * width + x); }
  std::uint8_t* at(int x, int y) { return rgb.data() + 3 * (static_cast<std::size_t>(y) * width + x); }
};

// One 16-bit number per pixel.
struct GrayImage {
  int width = 0, height = 0;
  std::vector<std::uint16_t> values;
};

// One of at most 256 colours (sRGB) per pixel.
struct IndexedImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> indices;
  std::vector<std::array<std::uint8_t, 3>> colours;
};

// A decoded texture: sRGB and alpha, first row on top.
struct Texture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

// Writes beside `path` and renames, so a reader never sees half a picture. Throws Error(Exit::file).
void write_png(const std::string& path, const Image& image);
void write_png(const std::string& path, const GrayImage& image);
void write_png(const std::string& path, const IndexedImage& image);
bool is_our_png(const std::string& path);    // written by write_png, as far as its first bytes tell
bool is_color_png(const std::string& path);  // 8 bits each of red, green and blue

// Throws Error(Exit::file) where it is not a readable PNG.
Image read_png(const std::string& path);

// PNG with alpha where some of it is below one.
std::vector<std::uint8_t> png_bytes(const Texture& texture);

// PNG or JPEG, from a file or from bytes; `name` is what messages cite. Throws Error(Exit::scene).
Texture read_texture(const std::string& path);
Texture read_texture(const std::vector<std::uint8_t>& bytes, const std::string& name);

}  // namespace mortise::render
