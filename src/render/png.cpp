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
bool encode(std::FILE* file, const Image& image) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  if (info == nullptr || setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_init_io(png, file);
  png_set_compression_level(png, 2);
  png_set_filter(png, 0, PNG_FILTER_SUB | PNG_FILTER_UP);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  char key[] = "Software", name[] = "mortise";  // by which is_our_png() knows it again
  png_text text = {};
  text.compression = PNG_TEXT_COMPRESSION_NONE, text.key = key, text.text = name, text.text_length = sizeof name - 1;
  png_set_text(png, info, &text, 1);
  png_write_info(png, info);
  for (int y = 0; y < image.height; ++y) png_write_row(png, image.at(0, y));
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return true;
}

}  // namespace

bool is_our_png(const std::string& path) {
  const File file(std::fopen(path.c_str(), "rb"));
  char head[256] = {};  // signature, header, sRGB and our words: about a hundred bytes
  const std::size_t n = file ? std::fread(head, 1, sizeof head, file.get()) : 0;
  return std::string_view(head, n).find(std::string_view("Software\0mortise", 16)) != std::string_view::npos;
}

void write_png(const std::string& path, const Image& image) {
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
