#include "run/sensor_maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "render/arrow.h"
#include "render/colour_map.h"
#include "render/font.h"
#include "render/overlay.h"
#include "run/folder.h"

namespace mortise::run {
namespace {

constexpr int kHeight = 540, kMargin = 48, kBar = 150;  // pixels
constexpr std::uint8_t kPaper[3] = {238, 240, 243}, kNothing[3] = {205, 208, 213}, kText[3] = {34, 37, 42};

void put(render::Image& image, int x, int y, const std::uint8_t* colour) {
  if (x >= 0 && y >= 0 && x < image.width && y < image.height) std::copy(colour, colour + 3, image.at(x, y));
}

// The largest 1, 2 or 5 times a power of ten that is not above `value`.
double round_down(double value) {
  const double power = std::pow(10, std::floor(std::log10(value))), lead = value / power;
  return power * (lead >= 5 ? 5 : lead >= 2 ? 2 : 1);
}

// An arrow beside the map, and what its length stands for.
void draw_shear_scale(render::Image& image, int left, double pixels_per_pascal) {
  constexpr double kLongest = 90, kSize = 16;  // pixels
  const double shear = round_down(kLongest / pixels_per_pascal);
  const auto [unit, scale] = render::pressure_unit(shear);
  render::draw_arrow(image, left, kHeight - 84, shear * pixels_per_pascal, 0);
  render::draw_text(image, fmt::format("shear  {:g} {}", shear * scale, unit), left, kHeight - 60, kSize, kText);
}

// Where it is in the sensor's frame, x across and y upwards from the middle of the grid: ticks below it and on its left.
void draw_axes(render::Image& image, const sensors::GridSpec& spec, int wide, int high) {
  constexpr double kSize = 13;  // pixels
  const double longer = std::max(spec.width, spec.height);
  const auto [unit, scale] = longer >= 1 ? std::pair{"m", 1.0} : longer >= 1e-3 ? std::pair{"mm", 1e3} : std::pair{"um", 1e6};
  const int bottom = kMargin + high;
  double end = 0;  // of the label before
  for (const auto& [value, label] : render::ticks(-0.5 * spec.width * scale, 0.5 * spec.width * scale)) {
    const double x = kMargin + wide * (0.5 + value / (spec.width * scale)), left = x - 0.5 * render::text_width(label, kSize);
    for (int i = 0; i < 5; ++i) put(image, static_cast<int>(x), bottom + i, kText);
    if (left > end) render::draw_text(image, label, left, bottom + 17, kSize, kText), end = left + render::text_width(label, kSize) + 4;
  }
  for (const auto& [value, label] : render::ticks(-0.5 * spec.height * scale, 0.5 * spec.height * scale)) {
    const double y = kMargin + high * (0.5 - value / (spec.height * scale));
    for (int i = 1; i < 6; ++i) put(image, kMargin - i, static_cast<int>(y), kText);
    render::draw_text(image, label, kMargin - 8 - render::text_width(label, kSize), y + 0.35 * kSize, kSize, kText);
  }
  render::draw_text(image, fmt::format("x  [{}]", unit), std::max(kMargin + wide + 8.0, end), bottom + 17, kSize, kText);
  render::draw_text(image, fmt::format("y  [{}]", unit), 8, kMargin - 14, kSize, kText);
}

render::Image map_of(const sensors::GridSpec& spec, const sensors::Reading& r, double low, double high_end, double shear_low, double shear_high) {
  const int high = kHeight - 2 * kMargin, wide = std::clamp(static_cast<int>(high * spec.width / spec.height), 60, 4 * high);
  render::Image image;
  image.width = wide + 2 * kMargin + kBar, image.height = kHeight;
  image.rgb.resize(3 * static_cast<std::size_t>(image.width) * image.height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) put(image, x, y, kPaper);
  const render::ColourMap colours = render::map_for(low, high_end);
  for (int y = 0; y < high; ++y)
    for (int x = 0; x < wide; ++x) {
      const int row = spec.rows - 1 - y * spec.rows / high, column = x * spec.columns / wide, taxel = row * spec.columns + column;
      const double fraction = std::clamp((r.pressure[taxel] - low) / (high_end - low), 0.0, 1.0);
      const std::uint8_t* colour = &colours[3 * static_cast<std::size_t>(std::lround(255 * fraction))];
      put(image, kMargin + x, kMargin + y, r.area[taxel] > 0 ? colour : kNothing);
    }
  draw_axes(image, spec, wide, high);
  if (!(shear_high > 0)) return image;
  // The longest arrow goes one and a half taxels far.
  const double length = 1.5 * std::min(static_cast<double>(wide) / spec.columns, static_cast<double>(high) / spec.rows) / shear_high;  // per pascal
  for (int i = 0; i < spec.taxels(); ++i) {
    const double u = r.shear[2 * i], v = r.shear[2 * i + 1], size = std::hypot(u, v);
    if (size < shear_low || size == 0) continue;
    const double shown = length * std::min(1.0, shear_high / size);
    const double x = kMargin + (i % spec.columns + 0.5) * wide / spec.columns;
    const double y = kMargin + (spec.rows - 0.5 - i / spec.columns) * high / spec.rows;
    render::draw_arrow(image, x, y, shown * u, -shown * v);
  }
  draw_shear_scale(image, kMargin + wide + 58, length);
  return image;
}

}  // namespace

SensorMaps::SensorMaps(const Params& scene, const sensors::Sensors& sensors, const std::string& folder)
    : scene_(scene), sensors_(sensors), folder_(folder), pressure_(sensors.all().size(), 0.0), shear_(pressure_) {
  make_pictures_folder(folder);
}

void SensorMaps::checkpoint(Archive& archive) {
  archive.io("pressure", pressure_);
  archive.io("shear", shear_);
}

void SensorMaps::see(const std::vector<sensors::Reading>& readings) {
  for (std::size_t s = 0; s < readings.size(); ++s) {
    const sensors::Reading& r = readings[s];
    for (double p : r.pressure) pressure_[s] = std::max(pressure_[s], p);
    for (std::size_t i = 0; i < r.pressure.size(); ++i) shear_[s] = std::max(shear_[s], std::hypot(r.shear[2 * i], r.shear[2 * i + 1]));
  }
}

SensorMaps::Scale SensorMaps::scale_of(std::size_t s) const {
  constexpr double kVisible = 0.05;  // of the longest arrow
  Scale scale{0, pressure_[s] > 0 ? pressure_[s] : 1, kVisible * shear_[s], shear_[s]};
  const Params& sensor = scene_.at("sensors").at(sensors_.all()[s].name());
  if (const Params* range = sensor.find("range")) scale.low = range->as_numbers()[0], scale.high = range->as_numbers()[1];
  if (const Params* range = sensor.find("shear_range")) scale.shear_low = range->as_numbers()[0], scale.shear_high = range->as_numbers()[1];
  return scale;
}

void SensorMaps::draw(long frame, double time, const std::vector<sensors::Reading>& readings) const {
  for (std::size_t s = 0; s < readings.size(); ++s) {
    const sensors::Sensor& sensor = sensors_.all()[s];
    const Scale scale = scale_of(s);
    render::Image image = map_of(sensor.spec(), readings[s], scale.low, scale.high, scale.shear_low, scale.shear_high);
    render::RenderJob job;
    const auto [unit, factor] = render::pressure_unit(std::max(std::abs(scale.low), std::abs(scale.high)));
    job.bar = render::ColourBar{"pressure", unit, scale.low, scale.high, factor};
    job.caption = fmt::format("{}   t = {:.4g} s", sensor.name(), time);
    render::draw_overlays(image, job);
    const std::string path = fmt::format("{}/sensor_{}_{:04}.png", folder_, sensor.name(), frame);
    guard_picture(path);
    render::write_png(path, image);
  }
}

}  // namespace mortise::run
