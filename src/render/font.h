#pragma once
#include <string_view>

#include "render/image.h"

namespace mortise::render {

// Width of one line of UTF-8 text [pixels] at a height of `size` pixels between ascent and descent.
double text_width(std::string_view text, double size);

// Draws with its baseline at (x, y), anti-aliased, in DejaVu Sans (embedded). What falls off the picture is dropped.
void draw_text(Image& image, std::string_view text, double x, double y, double size, const std::uint8_t colour[3], double opacity = 1);

}  // namespace mortise::render
