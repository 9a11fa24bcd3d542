// Lines and convex shapes by how much of a pixel they cover, taken from the distance of its middle to them.
#include <algorithm>
#include <cmath>

#include "render/font.h"
#include "render/image.h"
#include "study/canvas.h"

namespace mortise::study {

struct PixelCanvas::Sheet {
  render::Image image;

  void blend(int x, int y, Colour c, double share) {
    if (x < 0 || y < 0 || x >= image.width || y >= image.height || share <= 0) return;
    std::uint8_t* p = image.at(x, y);
    const std::uint8_t to[] = {c.r, c.g, c.b};
    for (int k = 0; k < 3; ++k) p[k] = static_cast<std::uint8_t>(std::lround(p[k] + (to[k] - p[k]) * std::min(share, 1.0)));
  }

  // Colours where `distance` of a pixel's middle from what is drawn, negative inside, says so; in the box of the points, `around` wider.
  template <class Distance>
  void fill(const std::vector<Place2>& points, double around, Colour c, double opacity, const Distance& distance) {
    double x0 = 1e9, x1 = -1e9, y0 = 1e9, y1 = -1e9;
    for (const auto& [x, y] : points) x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
    for (int y = std::max(0, static_cast<int>(y0 - around - 1)); y <= std::min<int>(image.height - 1, static_cast<int>(y1 + around + 1)); ++y)
      for (int x = std::max(0, static_cast<int>(x0 - around - 1)); x <= std::min<int>(image.width - 1, static_cast<int>(x1 + around + 1)); ++x)
        blend(x, y, c, opacity * std::clamp(0.5 - distance(x + 0.5, y + 0.5), 0.0, 1.0));
  }
};

namespace {

double to_segment(double x, double y, const Place2& a, const Place2& b) {
  const double ux = b.first - a.first, uy = b.second - a.second, length = ux * ux + uy * uy;
  const double t = length > 0 ? std::clamp(((x - a.first) * ux + (y - a.second) * uy) / length, 0.0, 1.0) : 0;
  return std::hypot(x - a.first - t * ux, y - a.second - t * uy);
}

// The parts of a line that dashes leave.
std::vector<std::vector<Place2>> dashed(const std::vector<Place2>& points, const std::vector<double>& dashes) {
  if (dashes.empty()) return {points};
  std::vector<std::vector<Place2>> out;
  std::size_t at = 0;
  double left = dashes[0];
  bool on = true;
  std::vector<Place2> part{points.front()};
  for (std::size_t i = 1; i < points.size(); ++i) {
    Place2 from = points[i - 1];
    double length = std::hypot(points[i].first - from.first, points[i].second - from.second);
    while (length > left) {
      const double s = left / length;
      from = {from.first + s * (points[i].first - from.first), from.second + s * (points[i].second - from.second)};
      length -= left;
      part.push_back(from);
      if (on) out.push_back(part);
      part = {from}, on = !on, at = (at + 1) % dashes.size(), left = dashes[at];
    }
    left -= length;
    part.push_back(points[i]);
  }
  if (on && part.size() > 1) out.push_back(part);
  return out;
}

std::vector<Place2> zoomed(std::vector<Place2> points, double zoom) {
  for (auto& [x, y] : points) x *= zoom, y *= zoom;
  return points;
}

}  // namespace

PixelCanvas::PixelCanvas(double width, double height, double zoom) : sheet_(new Sheet), zoom_(zoom) {
  render::Image& i = sheet_->image;
  i.width = static_cast<int>(width * zoom), i.height = static_cast<int>(height * zoom);
  i.rgb.assign(3ul * static_cast<std::size_t>(i.width) * static_cast<std::size_t>(i.height), 255);
}

PixelCanvas::~PixelCanvas() { delete sheet_; }

void PixelCanvas::line(const std::vector<Place2>& points, const Stroke& stroke) {
  if (points.size() < 2) return;
  std::vector<double> dashes = stroke.dashes;
  for (double& d : dashes) d *= zoom_;
  const double half = std::max(0.5, 0.5 * stroke.width * zoom_);
  for (const std::vector<Place2>& part : dashed(zoomed(points, zoom_), dashes))
    sheet_->fill(part, half, stroke.colour, stroke.opacity, [&](double x, double y) {
      double least = 1e9;
      for (std::size_t i = 1; i < part.size(); ++i) least = std::min(least, to_segment(x, y, part[i - 1], part[i]));
      return least - half;
    });
}

void PixelCanvas::shape(const std::vector<Place2>& corners, Colour fill, double opacity, const Stroke* edge, const std::string&) {
  const std::vector<Place2> p = zoomed(corners, zoom_);
  double area = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Place2 &a = p[i], &b = p[(i + 1) % p.size()];
    area += a.first * b.second - b.first * a.second;
  }
  const double turn = area < 0 ? -1 : 1;
  sheet_->fill(p, 0, fill, opacity, [&](double x, double y) {
    double most = -1e9;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Place2 &a = p[i], &b = p[(i + 1) % p.size()];
      const double ux = b.first - a.first, uy = b.second - a.second, length = std::hypot(ux, uy);
      if (length > 0) most = std::max(most, turn * ((x - a.first) * uy - (y - a.second) * ux) / length);
    }
    return most;
  });
  if (!edge) return;
  std::vector<Place2> closed = corners;
  closed.push_back(corners.front());
  line(closed, *edge);
}

void PixelCanvas::text(Place2 at, const std::string& text, double size, Anchor anchor, Colour colour, bool upwards, bool bold) {
  const double height = size * 1.17 * zoom_, width = render::text_width(text, height);
  const std::uint8_t rgb[] = {colour.r, colour.g, colour.b};
  const double back = anchor == Anchor::start ? 0 : anchor == Anchor::middle ? 0.5 * width : width;
  for (int twice = 0; twice <= (bold ? 1 : 0); ++twice) {
    const double shift = 0.4 * twice * zoom_;
    if (!upwards) {
      render::draw_text(sheet_->image, text, at.first * zoom_ - back + shift, at.second * zoom_, height, rgb);
      continue;
    }
    // On a sheet of its own, as a mask, turned to the left.
    render::Image own{static_cast<int>(width + 4), static_cast<int>(2 * height), {}};
    own.rgb.assign(3ul * static_cast<std::size_t>(own.width) * static_cast<std::size_t>(own.height), 255);
    const std::uint8_t black[] = {0, 0, 0};
    const double base = 1.4 * height;
    render::draw_text(own, text, 0, base, height, black);
    for (int v = 0; v < own.height; ++v)
      for (int u = 0; u < own.width; ++u)
        sheet_->blend(static_cast<int>(std::lround(at.first * zoom_ + v - base)), static_cast<int>(std::lround(at.second * zoom_ + back - u)), colour,
                      1 - own.at(u, v)[0] / 255.0);
  }
}

void PixelCanvas::write(const std::string& path) const { render::write_png(path, sheet_->image); }

}  // namespace mortise::study
