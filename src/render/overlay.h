#pragma once
#include <string>
#include <utility>
#include <vector>

#include "render/job.h"

namespace mortise::render {

// Values 1, 2 or 5 times a power of ten that divide [low, high] into four to nine parts, with their labels.
std::vector<std::pair<double, std::string>> ticks(double low, double high);

// Unit and factor in which a pressure of this size is written: Pa, kPa or MPa.
std::pair<const char*, double> pressure_unit(double pressure);

// Rectangle of the gradient of the colour bar in a picture [pixels]; the highest value is at the top.
struct BarBox {
  int left, top, width, height;
};
BarBox bar_box(int width, int height);

// Text that can be read on any ground, its baseline at (x, y).
void draw_label(Image& image, const std::string& text, double x, double y, double size);

// Draws caption and colour bar over a finished picture.
void draw_overlays(Image& image, const RenderJob& job);

}  // namespace mortise::render
