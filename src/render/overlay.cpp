#include "render/overlay.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "render/arrow.h"
#include "render/camera.h"
#include "render/colour_map.h"
#include "render/font.h"

namespace mortise::render {
namespace {

// Light text on dark ground and the other way round, by the mean luminance under the text; a halo keeps it legible where the
// ground changes below it.
struct Ink {
  std::uint8_t text[3], soft[3], halo[3];
};
Ink ink_for(const Image& image, int x0, int y0, int x1, int y1) {
  double sum = 0;
  int count = 0;
  for (int y = std::max(0, y0); y < std::min(image.height, y1); ++y)
    for (int x = std::max(0, x0); x < std::min(image.width, x1); ++x, ++count) {
      const std::uint8_t* p = image.at(x, y);
      sum += 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
    }
  if (count > 0 && sum / count > 128) return {{34, 37, 42}, {96, 102, 110}, {226, 229, 233}};
  return {{240, 242, 245}, {176, 182, 190}, {30, 32, 36}};
}

void fill(Image& image, int x0, int y0, int x1, int y1, const std::uint8_t c[3]) {
  for (int y = std::max(0, y0); y < std::min(image.height, y1); ++y)
    for (int x = std::max(0, x0); x < std::min(image.width, x1); ++x) std::copy(c, c + 3, image.at(x, y));
}

void write(Image& image, const std::string& text, double x, double y, double size, const Ink& ink) {
  for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) draw_text(image, text, x + dx, y + dy, size, ink.halo, 0.3);
  draw_text(image, text, x, y, size, ink.text);
}

void draw_bar(Image& image, const ColourBar& bar) {
  const BarBox box = bar_box(image.width, image.height);
  const double size = std::max(10.0, image.height * 0.030);
  const int right = box.left + box.width, bottom = box.top + box.height;
  const Ink ink = ink_for(image, box.left, box.top, image.width, bottom);
  const ColourMap map = map_for(bar.low, bar.high);
  fill(image, box.left - 1, box.top - 1, right + 1, bottom + 1, ink.soft);
  for (int y = box.top; y < bottom; ++y) {
    const int i = static_cast<int>(std::lround(255.0 * (bottom - 1 - y) / (box.height - 1)));
    fill(image, box.left, y, right, y + 1, &map[3 * static_cast<std::size_t>(i)]);
  }
  for (const auto& [value, label] : ticks(bar.low * bar.scale, bar.high * bar.scale)) {
    const double t = (value / bar.scale - bar.low) / (bar.high - bar.low);
    const int y = bottom - 1 - static_cast<int>(std::lround(t * (box.height - 1)));
    fill(image, right + 1, y, right + 1 + std::max(4, static_cast<int>(size * 0.3)), y + 1, ink.soft);
    write(image, label, right + size * 0.5, y + size * 0.30, size * 0.92, ink);
  }
  // Title above, aligned with the right margin so that it never leaves the picture.
  const std::string title = bar.unit.empty() ? bar.label : bar.label + "  [" + bar.unit + "]";
  const double width = text_width(title, size);
  const double x = std::min(static_cast<double>(box.left), image.width - size * 0.8 - width);
  write(image, title, x, box.top - size * 0.75, size, ink);
}

}  // namespace

std::vector<std::pair<double, std::string>> ticks(double low, double high) {
  const double raw = (high - low) / 5, power = std::pow(10.0, std::floor(std::log10(raw)));
  const double lead = raw / power, step = power * (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10);
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  std::vector<std::pair<double, std::string>> list;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) {
    char text[32];
    const double value = k * step + 0.0;  // the ceiling of what is just below zero is -0
    if (step < 1e-4 || step >= 1e6)
      std::snprintf(text, sizeof text, "%g", value);
    else
      std::snprintf(text, sizeof text, "%.*f", decimals, value);
    list.emplace_back(value, text);
  }
  return list;
}

std::pair<const char*, double> pressure_unit(double pressure) {
  if (pressure >= 1e6) return {"MPa", 1e-6};
  if (pressure >= 1e3) return {"kPa", 1e-3};
  return {"Pa", 1};
}

BarBox bar_box(int width, int height) {
  const int w = std::max(6, static_cast<int>(height * 0.028));
  return {width - static_cast<int>(height * 0.14) - w, static_cast<int>(height * 0.22), w, static_cast<int>(height * 0.56)};
}

void draw_label(Image& image, const std::string& text, double x, double y, double size) {
  const int left = static_cast<int>(x), bottom = static_cast<int>(y);
  write(image, text, x, y, size, ink_for(image, left, static_cast<int>(y - size), left + static_cast<int>(text_width(text, size)), bottom));
}

void draw_overlays(Image& image, const RenderJob& job) {
  for (const Arrow& a : job.arrows) {
    const std::optional<Vec2> from = project(job, a.from), to = project(job, a.to);
    if (from && to) draw_arrow(image, (*from)[0], (*from)[1], (*to)[0] - (*from)[0], (*to)[1] - (*from)[1]);
  }
  if (!job.annotated) return;
  if (job.bar) draw_bar(image, *job.bar);
  if (job.caption.empty()) return;
  const double size = std::max(10.0, image.height * 0.030);
  draw_label(image, job.caption, std::floor(size * 1.1), std::floor(image.height - size * 1.1), size);
}

}  // namespace mortise::render
