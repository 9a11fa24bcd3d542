#include "render/font.h"

#include <cmath>
#include <cstdint>

#include "base/error.h"

#define STB_TRUETYPE_IMPLEMENTATION
#define STBTT_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_truetype.h>
#pragma GCC diagnostic pop

// The font file itself, so that a picture does not depend on what is installed.
asm(".section .rodata\n.balign 16\n.global mortise_font_data\nmortise_font_data:\n.incbin \"" MORTISE_FONT "\"\n.byte 0\n.previous\n");
extern "C" const unsigned char mortise_font_data[];

namespace mortise::render {
namespace {

const stbtt_fontinfo& font() {
  static const stbtt_fontinfo info = [] {
    stbtt_fontinfo f;
    if (stbtt_InitFont(&f, mortise_font_data, 0) == 0) throw Error(Exit::internal, "the embedded font is not readable");
    return f;
  }();
  return info;
}

// Next code point of UTF-8; malformed bytes stand for themselves.
int next(std::string_view text, std::size_t& i) {
  const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0; };
  const int c = byte(i++);
  const int more = c >= 0xF0 ? 3 : c >= 0xE0 ? 2 : c >= 0xC0 ? 1 : 0;
  int code = more == 0 ? c : c & (0x3F >> more);
  for (int k = 0; k < more; ++k) code = (code << 6) | (byte(i++) & 0x3F);
  return code;
}

double advance(int code, int following, double scale) {
  int width = 0, bearing = 0;
  stbtt_GetCodepointHMetrics(&font(), code, &width, &bearing);
  return scale * (width + (following != 0 ? stbtt_GetCodepointKernAdvance(&font(), code, following) : 0));
}

}  // namespace

double text_width(std::string_view text, double size) {
  const double scale = stbtt_ScaleForPixelHeight(&font(), static_cast<float>(size));
  double x = 0;
  for (std::size_t i = 0; i < text.size();) {
    const int code = next(text, i);
    std::size_t k = i;
    x += advance(code, k < text.size() ? next(text, k) : 0, scale);
  }
  return x;
}

void draw_text(Image& image, std::string_view text, double x, double y, double size, const std::uint8_t colour[3], double opacity) {
  const float scale = stbtt_ScaleForPixelHeight(&font(), static_cast<float>(size));
  for (std::size_t i = 0; i < text.size();) {
    const int code = next(text, i);
    const float fraction = static_cast<float>(x - std::floor(x));
    int w = 0, h = 0, left = 0, top = 0;
    unsigned char* glyph = stbtt_GetCodepointBitmapSubpixel(&font(), scale, scale, fraction, 0, code, &w, &h, &left, &top);
    for (int v = 0; v < h; ++v)
      for (int u = 0; u < w; ++u) {
        const int px = static_cast<int>(std::floor(x)) + left + u, py = static_cast<int>(std::lround(y)) + top + v;
        if (px < 0 || py < 0 || px >= image.width || py >= image.height) continue;
        const int a = static_cast<int>(opacity * glyph[v * w + u]);
        std::uint8_t* p = image.at(px, py);
        for (int c = 0; c < 3; ++c) p[c] = static_cast<std::uint8_t>((p[c] * (255 - a) + colour[c] * a + 127) / 255);
      }
    stbtt_FreeBitmap(glyph, nullptr);
    std::size_t k = i;
    x += advance(code, k < text.size() ? next(text, k) : 0, scale);
  }
}

}  // namespace mortise::render
