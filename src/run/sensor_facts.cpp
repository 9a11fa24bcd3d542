#include "run/sensor_facts.h"

#include <cmath>

namespace mortise::run {

void write_sensor_facts(const Params& scene, const sensors::Sensors& sensors, output::FieldFile& file) {
  const auto vector = [](const Vec3& v) { return std::vector<double>(v.data(), v.data() + 3); };
  for (const sensors::Sensor& s : sensors.all()) {
    const sensors::GridSpec& g = s.spec();
    const auto put = [&](const char* name, output::Fact value) { file.fact("sensor_" + s.name(), name, value); };
    put("body", s.body());
    put("moves_with", scene.at("sensors").at(s.name()).text("moves_with"));
    put("rows", std::int64_t{g.rows}), put("columns", std::int64_t{g.columns});
    put("width_m", g.width), put("height_m", g.height);  // along x, along y
    put("taxel_width_m", g.width / g.columns), put("taxel_height_m", g.height / g.rows);
    if (std::isfinite(g.depth)) put("depth_m", g.depth);
    // The frame at the start, in world coordinates: the middle of the grid, and its axes across, along `up` and out of the body.
    put("position_m", vector(g.frame.origin));
    put("x_axis", vector(g.frame.axes.col(0))), put("y_axis", vector(g.frame.axes.col(1))), put("normal", vector(g.frame.axes.col(2)));
  }
}

}  // namespace mortise::run
