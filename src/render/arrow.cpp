#include "render/arrow.h"

#include <algorithm>
#include <cmath>

namespace mortise::render {
namespace {

constexpr std::uint8_t kArrow[3] = {255, 255, 255}, kEdge[3] = {20, 22, 26};

struct Stroke {
  double x0, y0, x1, y1;
};

// All pixels nearer to the stroke than `radius`, with a soft edge.
void draw_stroke(Image& image, const Stroke& s, double radius, const std::uint8_t* colour) {
  const double dx = s.x1 - s.x0, dy = s.y1 - s.y0, square = dx * dx + dy * dy;
  const auto within = [&](double v, int last) {
    return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(last)));
  };  // an arrow may reach far out
  const int left = within(std::min(s.x0, s.x1) - radius - 1, image.width - 1), right = within(std::max(s.x0, s.x1) + radius + 1, image.width - 1),
            top = within(std::min(s.y0, s.y1) - radius - 1, image.height - 1), bottom = within(std::max(s.y0, s.y1) + radius + 1, image.height - 1);
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) {
      const double t = square > 0 ? std::clamp(((x - s.x0) * dx + (y - s.y0) * dy) / square, 0.0, 1.0) : 0;
      const double cover = std::clamp(radius + 0.5 - std::hypot(x - s.x0 - t * dx, y - s.y0 - t * dy), 0.0, 1.0);
      std::uint8_t* p = image.at(x, y);
      for (int c = 0; c < 3; ++c) p[c] = static_cast<std::uint8_t>(std::lround(p[c] + cover * (colour[c] - p[c])));
    }
}

}  // namespace

void draw_arrow(Image& image, double x, double y, double dx, double dy) {
  const double length = std::hypot(dx, dy);
  if (length < 1) return;
  const double head = std::min(9.0, 0.4 * length), ux = dx / length, uy = dy / length, x1 = x + dx, y1 = y + dy;
  const auto barb = [&](double side) { return Stroke{x1, y1, x1 - head * (ux + 0.5 * side * uy), y1 - head * (uy - 0.5 * side * ux)}; };
  const Stroke strokes[] = {{x, y, x1, y1}, barb(1), barb(-1)};
  for (const Stroke& s : strokes) draw_stroke(image, s, 1.9, kEdge);
  for (const Stroke& s : strokes) draw_stroke(image, s, 0.7, kArrow);
}

}  // namespace mortise::render
