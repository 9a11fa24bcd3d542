#pragma once
#include "render/image.h"

namespace mortise::render {

// An arrow over a finished picture, from (x, y) by (dx, dy) [pixels], y downwards. Light with a dark edge: legible on every colour. Shorter than a
// pixel: none.
void draw_arrow(Image& image, double x, double y, double dx, double dy);

}  // namespace mortise::render
