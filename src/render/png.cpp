#include <fcntl.h>
#include <png.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string_view>

#include "base/error.h"
#include "render/image.h"

namespace mortise::render {
namespace {

struct Close {
  void operator()(std::FILE* f) const { std::fclose(f); }
};
using File = std::unique_ptr<std::FILE, Close>;

// libpng reports through longjmp; nothing with a destructor lives in this frame.
struct Rows {
  int width, height, bits, type;          // of a sample; libpng's colour type
  const void* data;                       // rows from the top, samples as they lie in memory
  std::size_t stride;                     // [bytes]
  const std::vector<png_color>* colours;  // of indices, or null
};
bool encode(std::FILE* file, const Rows& image) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  if (info == nullptr || setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_init_io(png, file);
  png_set_compression_level(png, 2);
  png_set_filter(png, 0, PNG_FILTER_SUB | PNG_FILTER_UP);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), image.bits, image.type, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (image.type != PNG_COLOR_TYPE_GRAY) png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  if (image.colours != nullptr) png_set_PLTE(png, info, image.colours->data(), static_cast<int>(image.colours->size()));
  char key[] = "Software", name[] = "mortise";  // by which is_our_png() knows it again
  png_text text = {};
  text.compression = PNG_TEXT_COMPRESSION_NONE, text.key = key, text.text = name, text.text_length = sizeof name - 1;
  png_set_text(png, info, &text, 1);
  png_write_info(png, info);
  if (image.bits == 16) png_set_swap(png);  // PNG is big-endian
  for (int y = 0; y < image.height; ++y) png_write_row(png, static_cast<png_const_bytep>(image.data) + image.stride * static_cast<std::size_t>(y));
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return true;
}

}  // namespace

bool is_color_png(const std::string& path) {
  const File file(std::fopen(path.c_str(), "rb"));
  unsigned char head[26] = {};  // signature; of the header size, bits and type
  return file && std::fread(head, 1, sizeof head, file.get()) == sizeof head && head[24] == 8 && head[25] == PNG_COLOR_TYPE_RGB;
}

bool is_our_png(const std::string& path) {
  const File file(std::fopen(path.c_str(), "rb"));
  char head[1024] = {};  // signature, header, sRGB, up to 256 colours and our words
  const std::size_t n = file ? std::fread(head, 1, sizeof head, file.get()) : 0;
  return std::string_view(head, n).find(std::string_view("Software\0mortise", 16)) != std::string_view::npos;
}

namespace {

void write(const std::string& path, const Rows& image) {
  const std::string part = path + ".part";
  ::unlink(part.c_str());
  int reason = 0;
  const int descriptor = ::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor < 0) reason = errno;
  if (reason == 0) {
    const File file(::fdopen(descriptor, "wb"));
    errno = 0;
    if (!file || !encode(file.get(), image) || std::fflush(file.get()) != 0) reason = errno != 0 ? errno : EIO;
  }
  if (reason == 0 && std::rename(part.c_str(), path.c_str()) != 0) reason = errno;
  if (reason == 0) return;
  if (descriptor >= 0) ::unlink(part.c_str());
  throw Error(Exit::file, "cannot write the picture " + path + ": " + std::strerror(reason));
}

}  // namespace

void write_png(const std::string& path, const Image& image) {
  write(path, {image.width, image.height, 8, PNG_COLOR_TYPE_RGB, image.rgb.data(), 3 * static_cast<std::size_t>(image.width), nullptr});
}

void write_png(const std::string& path, const GrayImage& image) {
  write(path, {image.width, image.height, 16, PNG_COLOR_TYPE_GRAY, image.values.data(), 2 * static_cast<std::size_t>(image.width), nullptr});
}

void write_png(const std::string& path, const IndexedImage& image) {
  std::vector<png_color> colours;
  for (const auto& c : image.colours) colours.push_back({c[0], c[1], c[2]});
  write(path, {image.width, image.height, 8, PNG_COLOR_TYPE_PALETTE, image.indices.data(), static_cast<std::size_t>(image.width), &colours});
}

std::vector<std::uint8_t> png_bytes(const Texture& texture) {
  bool opaque = true;
  for (std::size_t i = 3; i < texture.rgba.size(); i += 4) opaque = opaque && texture.rgba[i] == 255;
  std::vector<std::uint8_t> rgb;
  if (opaque) {
    rgb.reserve(texture.rgba.size() / 4 * 3);
    for (std::size_t i = 0; i < texture.rgba.size(); i += 4) rgb.insert(rgb.end(), &texture.rgba[i], &texture.rgba[i] + 3);
  }
  png_image header;
  std::memset(&header, 0, sizeof header);
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(texture.width), header.height = static_cast<png_uint_32>(texture.height);
  header.format = opaque ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
  const void* pixels = opaque ? rgb.data() : texture.rgba.data();
  png_alloc_size_t size = 0;
  std::vector<std::uint8_t> out;
  if (png_image_write_to_memory(&header, nullptr, &size, 0, pixels, 0, nullptr) != 0) {
    out.resize(size);
    if (png_image_write_to_memory(&header, out.data(), &size, 0, pixels, 0, nullptr) != 0) {
      out.resize(size);
      return out;
    }
  }
  throw Error(Exit::internal, std::string("a texture cannot be written as PNG: ") + header.message);
}

Image read_png(const std::string& path) {
  png_image header;
  std::memset(&header, 0, sizeof header);
  header.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&header, path.c_str()) == 0) throw Error(Exit::file, "cannot read the picture " + path + ": " + header.message);
  if (header.width > 16384 || header.height > 16384) {
    png_image_free(&header);
    throw Error(Exit::file, "the picture " + path + " is larger than 16384 x 16384 pixels");
  }
  header.format = PNG_FORMAT_RGB;
  Image image{static_cast<int>(header.width), static_cast<int>(header.height), {}};
  image.rgb.resize(PNG_IMAGE_SIZE(header));
  if (png_image_finish_read(&header, nullptr, image.rgb.data(), 0, nullptr) == 0)
    throw Error(Exit::file, "cannot read the picture " + path + ": " + header.message);
  return image;
}

}  // namespace mortise::render
