#include "run/sensor_maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "render/colour_map.h"
#include "render/overlay.h"
#include "run/folder.h"

namespace mortise::run {
namespace {

constexpr int kHeight = 540, kMargin = 48, kBar = 150;  // pixels
constexpr std::uint8_t kPaper[3] = {238, 240, 243}, kNothing[3] = {205, 208, 213}, kLine[3] = {255, 255, 255};

void put(render::Image& image, int x, int y, const std::uint8_t* colour) {
  if (x >= 0 && y >= 0 && x < image.width && y < image.height) std::copy(colour, colour + 3, image.at(x, y));
}

void line(render::Image& image, double x0, double y0, double x1, double y1) {
  const int steps = 1 + static_cast<int>(std::max(std::abs(x1 - x0), std::abs(y1 - y0)));
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    put(image, static_cast<int>(x0 + t * (x1 - x0)), static_cast<int>(y0 + t * (y1 - y0)), kLine);
  }
}

// Scale of numbers at the colour bar.
std::pair<const char*, double> unit_for(double pressure) {
  if (pressure >= 1e6) return {"MPa", 1e-6};
  if (pressure >= 1e3) return {"kPa", 1e-3};
  return {"Pa", 1};
}

render::Image map_of(const sensors::GridSpec& spec, const sensors::Reading& r, double most, double most_shear) {
  const int high = kHeight - 2 * kMargin, wide = std::clamp(static_cast<int>(high * spec.width / spec.height), 60, 4 * high);
  render::Image image;
  image.width = wide + 2 * kMargin + kBar, image.height = kHeight;
  image.rgb.resize(3 * static_cast<std::size_t>(image.width) * image.height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) put(image, x, y, kPaper);
  const render::ColourMap colours = render::sequential_map();
  for (int y = 0; y < high; ++y)
    for (int x = 0; x < wide; ++x) {
      const int row = spec.rows - 1 - y * spec.rows / high, column = x * spec.columns / wide, taxel = row * spec.columns + column;
      const double share = std::clamp(r.pressure[taxel] / most, 0.0, 1.0);
      const std::uint8_t* colour = &colours[3 * static_cast<std::size_t>(std::lround(255 * share))];
      put(image, kMargin + x, kMargin + y, r.area[taxel] > 0 ? colour : kNothing);
    }
  const double length = 1.5 * std::min(static_cast<double>(wide) / spec.columns, static_cast<double>(high) / spec.rows);  // of the largest shear
  for (int i = 0; i < spec.taxels() && most_shear > 0; ++i) {
    const double u = r.shear[2 * i] / most_shear, v = r.shear[2 * i + 1] / most_shear;
    if (std::hypot(u, v) < 0.05) continue;
    const double x = kMargin + (i % spec.columns + 0.5) * wide / spec.columns;
    const double y = kMargin + (spec.rows - 0.5 - i / spec.columns) * high / spec.rows;
    line(image, x, y, x + length * u, y - length * v);
  }
  return image;
}

}  // namespace

SensorMaps::SensorMaps(const sensors::Sensors& sensors, const std::string& folder)
    : sensors_(sensors), folder_(folder), pressure_(sensors.all().size(), 0.0), shear_(pressure_) {
  make_pictures_folder(folder);
}

void SensorMaps::checkpoint(Archive& archive) {
  archive.io("pressure", pressure_);
  archive.io("shear", shear_);
}

void SensorMaps::draw(long frame, double time) {
  for (std::size_t s = 0; s < sensors_.all().size(); ++s) {
    const sensors::Sensor& sensor = sensors_.all()[s];
    const sensors::Reading& r = sensors_.readings().at(s);
    for (double p : r.pressure) pressure_[s] = std::max(pressure_[s], p);
    for (std::size_t i = 0; i < r.pressure.size(); ++i) shear_[s] = std::max(shear_[s], std::hypot(r.shear[2 * i], r.shear[2 * i + 1]));
    const double most = pressure_[s] > 0 ? pressure_[s] : 1;
    render::Image image = map_of(sensor.spec(), r, most, shear_[s]);
    render::RenderJob job;
    const auto [unit, scale] = unit_for(most);
    job.bar = render::ColourBar{"pressure", unit, 0, most, scale};
    job.caption = fmt::format("{}   t = {:.4g} s", sensor.name(), time);
    render::draw_overlays(image, job);
    const std::string path = fmt::format("{}/sensor_{}_{:04}.png", folder_, sensor.name(), frame);
    guard_picture(path);
    render::write_png(path, image);
  }
}

}  // namespace mortise::run
