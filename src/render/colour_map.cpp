#include "render/colour_map.h"

#include <algorithm>
#include <cmath>

namespace mortise::render {
namespace {

double srgb_of_linear(double c) { return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055; }

// OKLab -> linear sRGB, coefficients from Ottosson (2020).
std::array<double, 3> linear_of_oklab(double lightness, double a, double b) {
  const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
  const double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
  const double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s, -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

bool shown(const std::array<double, 3>& c) { return *std::min_element(c.begin(), c.end()) >= 0 && *std::max_element(c.begin(), c.end()) <= 1; }

// Lightness and hue are kept; chroma stays below nine tenths of what a screen can show there.
void put(ColourMap& map, int i, double lightness, double chroma, double hue_degrees) {
  const double h = hue_degrees * 3.14159265358979323846 / 180;
  double low = 0, high = 0.5;
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (low + high);
    (shown(linear_of_oklab(lightness, middle * std::cos(h), middle * std::sin(h))) ? low : high) = middle;
  }
  chroma = std::min(chroma, 0.9 * low);
  const auto c = linear_of_oklab(lightness, chroma * std::cos(h), chroma * std::sin(h));
  for (int k = 0; k < 3; ++k) map[3 * i + k] = static_cast<std::uint8_t>(std::lround(255 * srgb_of_linear(std::clamp(c[k], 0.0, 1.0))));
}

}  // namespace

double linear_of_srgb(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }

ColourMap sequential_map() {
  ColourMap map{};
  for (int i = 0; i < 256; ++i) {
    const double t = i / 255.0;
    // Chroma rises quickly from zero, so the start is neutral, and falls towards the pale end.
    const double chroma = 0.21 * (1 - std::exp(-9 * t)) * (1 - 0.4 * t * t);
    put(map, i, 0.24 + 0.73 * t, chroma, 275 + 190 * t);
  }
  return map;
}

ColourMap diverging_map(double zero) {
  ColourMap map{};
  for (int i = 0; i < 256; ++i) {
    const double t = i / 255.0 - zero, s = t / std::max(zero, 1 - zero);
    put(map, i, 0.90 - 0.5 * std::abs(s), 0.20 * std::abs(s), s < 0 ? 255 : 45);
  }
  return map;
}

ColourMap map_for(double low, double high) { return low < 0 && high > 0 ? diverging_map(-low / (high - low)) : sequential_map(); }

}  // namespace mortise::render
